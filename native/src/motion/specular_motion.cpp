#include "motion/specular_motion.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "motion/chain_view.h"
#include "motion/snapshot_motion.h"
#include "path/context.h"

namespace gradus::motion {

namespace {

// Side of a tile in pixels. Pixels are tracked in small tiles, row by row, because the search in a pixel starts from
// the motion of its neighbours.
constexpr int32_t kTile = 16;
// Tolerance of the occlusion test, relative to the distance: a hit closer to the target may be the target's own
// surface.
constexpr float kOwnSurface = 1e-3f;

size_t pixel_of(const Region& part, int32_t x, int32_t y) {
  return size_t(y - part.y0) * size_t(part.width()) + size_t(x - part.x0);
}

// Result for one pixel.
struct Track {
  Tracking tracking = Tracking::NoPath;
  Vec2 film{0.0f};
  const SpecularChain* chain = nullptr;  // chain in the first frame
};

// Neighbours of a pixel that were tracked before it; nullptr if they are outside the tile.
struct Neighbours {
  const Track *left, *below, *corner;
};

// Tracks the chains of single pixels.
class ChainTracker {
 public:
  // known: motion of another view over the same part, or nullptr.
  ChainTracker(const ChainView& from, const ChainTracer& to, const Region& part, const KnownMotion* known,
               SearchSteps steps)
      : from_(from),
        here_(from.tracer()),
        to_(to),
        motion_(here_.snapshot(), to.snapshot()),
        part_(part),
        known_(known),
        steps_(steps) {}

  // Returns the chain of a pixel in the first frame, or nullptr.
  const SpecularChain* chain(int32_t x, int32_t y) const { return from_.at(x, y); }

  Track track(int32_t x, int32_t y, const SpecularChain& chain, const Neighbours& before,
              TrackingCounts* counts) const {
    Track result{Tracking::Tracked, path::pixel_centre(x, y), &chain};
    if (chain.is_static) return result;
    if (is_known(chain, x, y)) {
      const size_t pixel = pixel_of(part_, x, y);
      result.film = known_->motion.film[pixel];
      result.tracking = known_->motion.tracking[pixel];
      return result;
    }
    Target target;
    if (!find_target(chain, &target)) {
      result.tracking = Tracking::Gone;
    } else if (chain.signature.length == 0) {
      straight(target, &result);
    } else {
      search(target, x, y, before, &result, counts);
    }
    result.film = on_film(result.film);
    const Vec2 displacement = glm::abs(to_.camera().film_displacement(path::pixel_centre(x, y), result.film));
    const bool inside = displacement.x <= float(to_.settings().width) && displacement.y <= float(to_.settings().height);
    if (result.tracking == Tracking::Tracked && !inside) result.tracking = Tracking::Outside;
    if (result.tracking != Tracking::Tracked) result.film = path::pixel_centre(x, y);
    return result;
  }

 private:
  // Computes what the chain shows, in the other frame. Returns false if it does not exist there.
  bool find_target(const SpecularChain& chain, Target* target) const {
    target->in_sky = chain.end == ChainEnd::Sky;
    target->place = chain.ray.ray.direction;
    return target->in_sky || motion_.position(chain.last, &target->place);
  }
  // Returns what the chain shows in the first frame.
  static Target own_target(const SpecularChain& chain) {
    const bool in_sky = chain.end == ChainEnd::Sky;
    return {in_sky ? chain.ray.ray.direction : chain.shown, in_sky};
  }

  // Whether the chain shows something directly that the view with known motion shows as well.
  bool is_known(const SpecularChain& chain, int32_t x, int32_t y) const {
    if (known_ == nullptr || chain.signature.length > 0) return false;
    const SpecularChain* other = known_->view.at(x, y);
    return other != nullptr && other->signature.length == 0 && other->end == chain.end && other->last == chain.last;
  }

  // Tracks what is seen directly.
  void straight(const Target& target, Track* track) const {
    // An orthographic camera sees the sky in the same direction in all pixels, so that it does not move on the film.
    const bool is_static = target.in_sky && here_.snapshot().camera.type == GRADUS_CAMERA_ORTHOGRAPHIC;
    const bool seen =
        is_static || (target.in_sky ? to_.camera().project_direction(target.place, Moment::Now, &track->film)
                                    : to_.camera().project(target.place, Moment::Now, &track->film));
    SpecularChain chain;
    const bool found = seen && to_.follow(track->film, SpecularSignature{}, &chain);
    track->tracking = !found ? Tracking::Outside : is_occluded(target, chain) ? Tracking::Occluded : Tracking::Tracked;
  }

  bool is_occluded(const Target& target, const SpecularChain& chain) const {
    const float distance =
        target.in_sky ? kInfinity
                      : glm::dot(target.place - chain.ray.ray.origin, chain.ray.ray.direction) * (1.0f - kOwnSurface);
    geometry::Hit hit;
    return to_.meets(chain, distance) && to_.finish(chain, &hit) && hit.t < distance;
  }

  // Searches for the target through smooth surfaces: in one step in time from several estimates in turn, then, if
  // wanted, in smaller steps.
  void search(const Target& target, int32_t x, int32_t y, const Neighbours& before, Track* track,
              TrackingCounts* counts) const {
    const SpecularChain& chain = *track->chain;
    const Vec2 centre = path::pixel_centre(x, y);
    const Target own = own_target(chain);
    Vec2 first = centre;
    const bool is_there = first_vertex(chain, &first);
    const FilmSearch::Problem problem{here_, to_,    chain.signature,
                                      own,   target, to_.camera().film_displacement(centre, first)};
    SearchCounts searched;
    FilmSearch newton(problem, &searched);
    FilmPlace start{centre, chain, chain_jacobian(from_, own, x, y)}, found;
    track->tracking = Tracking::Broken;
    if (!newton.complete(&start)) return;
    // Returns false if nothing else is to be tried. The cause of the first failure is kept.
    const auto attempt = [&](SearchEnd end) {
      const bool is_first = track->tracking == Tracking::Broken, is_found = end == SearchEnd::Found;
      if (is_first || is_found) track->tracking = judge(end, target, found);
      if (is_found) track->film = found.film;
      return !is_found && !(is_first && end == SearchEnd::Ended);
    };
    const std::optional<Vec2> guess = guess_by(before, chain.signature);
    // The motion of the neighbours may belong to another image of the target.
    bool is_open = !guess || attempt(newton.leap(start, *guess, &found)) || track->tracking == Tracking::Broken;
    if (is_open && is_there) is_open = attempt(newton.leap(start, first, &found));
    if (is_open && steps_ == SearchSteps::Several) attempt(newton.march(start, &found));
    if (track->tracking != Tracking::Tracked) return;
    counts->search.traced += searched.traced;
    counts->search.space += searched.space;
    counts->search.time += searched.time;
    ++counts->searched;
  }

  // Predicts the position from neighbours with the same signature: linearly from three of them, or from the motion of
  // one.
  std::optional<Vec2> guess_by(const Neighbours& before, const SpecularSignature& signature) const {
    const auto leads = [&](const Track* track) {
      return track != nullptr && track->tracking == Tracking::Tracked && track->chain->signature == signature;
    };
    const bool beside = leads(before.left), under = leads(before.below);
    if (beside && under && leads(before.corner))
      return before.left->film + to_.camera().film_displacement(before.corner->film, before.below->film);
    if (beside) return before.left->film + Vec2(1, 0);
    if (under) return before.below->film + Vec2(0, 1);
    return std::nullopt;
  }

  // Returns a position within the width of the film: a search may cross the seam of a panorama, whose film is periodic.
  Vec2 on_film(const Vec2& film) const {
    const auto width = float(to_.settings().width);
    if (film.x >= 0.0f && film.x < width) return film;
    const Vec2 middle(0.5f * width, film.y);
    return middle + to_.camera().film_displacement(middle, film);
  }

  // Computes the film position in the other frame of the first smooth vertex. A static vertex keeps its position
  // exactly. Returns false if the vertex does not exist there or is not on the film.
  bool first_vertex(const SpecularChain& chain, Vec2* film) const {
    Vec3 position;
    Vec2 there;
    if (!motion_.position(chain.first, &position) || !to_.camera().project(position, Moment::Now, &there)) return false;
    if (glm::length(there - *film) > FilmSearch::kFilmTolerance) *film = there;
    return true;
  }

  Tracking judge(SearchEnd end, const Target& target, const FilmPlace& place) const {
    if (end == SearchEnd::Broken || end == SearchEnd::Ended) return Tracking::Broken;
    if (end == SearchEnd::Stuck) return Tracking::NotConverged;
    if (end == SearchEnd::Turned) return Tracking::Elsewhere;
    return is_occluded(target, place.chain) ? Tracking::Occluded : Tracking::Tracked;
  }

  const ChainView& from_;
  ChainTracer here_;
  const ChainTracer& to_;
  SnapshotMotion motion_;
  const Region& part_;
  const KnownMotion* known_;
  SearchSteps steps_;
};

}  // namespace

void TrackingCounts::add(const TrackingCounts& other) {
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] += other.pixels[i];
  search.traced += other.search.traced;
  search.space += other.search.space;
  search.time += other.search.time;
  searched += other.searched;
}

namespace {

// Tracks the rows of a tile in order.
class Tile {
 public:
  Tile(const ChainTracker& tracker, const Region& part, int32_t x0, ChainMotion* motion, TrackingCounts* counts)
      : tracker_(tracker),
        part_(part),
        x0_(x0),
        x1_(std::min(x0 + kTile, part.x1)),
        motion_(*motion),
        counts_(*counts) {}

  void track_row(int32_t y) {
    std::swap(row_, below_);
    size_t pixel = pixel_of(part_, x0_, y);
    for (int32_t x = x0_; x < x1_; ++x, ++pixel) {
      Track& own = row_[size_t(x - x0_)];
      const SpecularChain* chain = tracker_.chain(x, y);
      own = chain != nullptr ? tracker_.track(x, y, *chain, neighbours(size_t(x - x0_)), &counts_) : Track{};
      if (chain != nullptr) motion_.film[pixel] = own.film;
      motion_.tracking[pixel] = own.tracking;
      ++counts_.pixels[own.tracking == Tracking::Tracked ? 0 : size_t(-int(own.tracking))];
    }
  }

 private:
  Neighbours neighbours(size_t i) const {
    const bool first = i == 0;
    return {first ? nullptr : &row_[i - 1], &below_[i], first ? nullptr : &below_[i - 1]};
  }

  const ChainTracker& tracker_;
  const Region& part_;
  int32_t x0_, x1_;
  ChainMotion& motion_;
  TrackingCounts& counts_;
  std::array<Track, kTile> row_, below_;
};

}  // namespace

ChainMotion track_chains(const ChainView& from, const ChainTracer& to, const Region& part,
                         const CancelCheck& is_cancelled, const KnownMotion* known, SearchSteps steps) {
  const auto pixels = size_t(part.area());
  ChainMotion motion{{}, std::vector<Tracking>(pixels, Tracking::NotConverged), {}};
  motion.film.reserve(pixels);
  for (int32_t y = part.y0; y < part.y1; ++y)
    for (int32_t x = part.x0; x < part.x1; ++x) motion.film.push_back(path::pixel_centre(x, y));
  if (to.snapshot().is_other_shot || is_shot_change(from.centres->snapshot->camera, to.snapshot().camera)) {
    std::fill(motion.tracking.begin(), motion.tracking.end(), Tracking::ShotChange);
    motion.counts.pixels[size_t(-int(Tracking::ShotChange))] = pixels;
    return motion;
  }
  const ChainTracker tracker(from, to, part, known, steps);
  tbb::enumerable_thread_specific<TrackingCounts> counts;
  const auto tiles = [](int32_t length) { return (length + kTile - 1) / kTile; };
  tbb::parallel_for(tbb::blocked_range2d<int32_t>(0, tiles(part.height()), 1, 0, tiles(part.width()), 1),
                    [&](const auto& range) {
                      for (int32_t ty = range.rows().begin(); ty < range.rows().end(); ++ty)
                        for (int32_t tx = range.cols().begin(); tx < range.cols().end(); ++tx) {
                          Tile tile(tracker, part, part.x0 + tx * kTile, &motion, &counts.local());
                          const int32_t y0 = part.y0 + ty * kTile, y1 = std::min(y0 + kTile, part.y1);
                          for (int32_t y = y0; y < y1 && !is_cancelled(); ++y) tile.track_row(y);
                        }
                    });
  for (const TrackingCounts& c : counts) motion.counts.add(c);
  return motion;
}

}  // namespace gradus::motion
