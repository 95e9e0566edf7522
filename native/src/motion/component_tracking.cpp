#include "motion/component_tracking.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/fault.h"
#include "bsdf/closures.h"
#include "motion/pixel_matching.h"
#include "motion/snapshot_motion.h"

namespace gradus::motion {

namespace {

// Returns a copy of rows [y0, y1) of a view.
CentreView rows_of(const CentreView& view, int32_t y0, int32_t y1) {
  const auto place = [&](int32_t y) { return ptrdiff_t(y - view.region.y0) * view.region.width(); };
  const auto rows = [&](const auto& list) {
    return std::decay_t<decltype(list)>(list.begin() + place(y0), list.begin() + place(y1));
  };
  return {view.snapshot, view.camera, {view.region.x0, y0, view.region.x1, y1}, rows(view.hits), rows(view.directions)};
}

// Removes the chains without smooth vertices.
void exclude_directly_seen(ChainView* view) {
  for (int32_t& place : view->places) {
    if (place >= 0 && view->chains[size_t(place)].signature.length == 0) place = -1;
  }
}

void append(const ChainMotion& rows, ChainMotion* motion) {
  motion->film.insert(motion->film.end(), rows.film.begin(), rows.film.end());
  motion->tracking.insert(motion->tracking.end(), rows.tracking.begin(), rows.tracking.end());
  motion->counts.add(rows.counts);
}

std::vector<ChainMotion> track(const CentreView& from, const ChainTracer& to, const lpe::ComponentSet& components,
                               uint32_t wanted, float non_specular_above, SearchSteps steps,
                               const CancelCheck& is_cancelled) {
  Change change(*from.snapshot);
  change.add(to.snapshot());
  const Region& film = from.region;
  std::vector<ChainMotion> motion(size_t(std::popcount(wanted)));
  for (int32_t y = film.y0; y < film.y1; y += kTrackingBand) {
    const Region band{film.x0, y, film.x1, std::min(y + kTrackingBand, film.y1)};
    // The rows above and below are included, since chain_jacobian() needs the chains of neighbouring pixels.
    const CentreView rows = rows_of(from, std::max(y - 1, film.y0), std::min(band.y1 + 1, film.y1));
    std::vector<ChainView> views =
        view_chains(rows, to.settings(), components, wanted, is_cancelled, &change, non_specular_above);
    for (size_t k = 0; k < views.size(); ++k) {
      exclude_directly_seen(&views[k]);
      append(track_chains(views[k], to, band, is_cancelled, nullptr, steps), &motion[k]);
    }
  }
  return motion;
}

// Returns whether a pixel beside this one shows another instance at its centre: the two may share this pixel.
bool is_at_edge(const CentreView& view, size_t pixel) {
  return any_beside(view.region, pixel,
                    [&](size_t other) { return view.hits[other].instance != view.hits[pixel].instance; });
}

}  // namespace

std::vector<ChainMotion> track_components(const CentreView& from, const ChainTracer& to,
                                          const lpe::ComponentSet& components, uint32_t wanted,
                                          const CancelCheck& is_cancelled) {
  return track(from, to, components, wanted, 0.0f, SearchSteps::Several, is_cancelled);
}

ChainMotion track_dominant(const CentreView& from, const ChainTracer& to, const CancelCheck& is_cancelled) {
  const lpe::ComponentSet whole_picture;
  return std::move(
      track(from, to, whole_picture, whole_picture.all(), bsdf::kMaxNonSpecular, SearchSteps::One, is_cancelled)
          .front());
}

bool is_seen_through_smooth(const ChainMotion& motion) {
  return std::any_of(motion.tracking.begin(), motion.tracking.end(), [](Tracking t) { return t != Tracking::NoPath; });
}

film::PixelCorrespondence match_component(const film::PixelCorrespondence& surface, const Region& region,
                                          const ChainMotion& motion) {
  const size_t pixels = surface.pixel.size();
  film::PixelCorrespondence correspondence{std::vector<int32_t>(pixels, film::kNoCorrespondence),
                                           std::vector<Vec2>(pixels, Vec2(0.0f))};
  std::vector<int32_t> owner(pixels, film::kNoCorrespondence);
  std::vector<float> distances(pixels, kInfinity);
  for (size_t i = 0; i < pixels; ++i) {
    if (motion.tracking[i] != Tracking::Tracked) continue;
    const Vec2 film = motion.film[i];
    const int32_t there = pixel_at(region, film);
    if (there == film::kNoCorrespondence) continue;
    const auto next = size_t(there);
    const float distance = glm::length(film - centre_of(region, next));
    if (!(distance < distances[next])) continue;
    if (owner[next] != film::kNoCorrespondence) correspondence.pixel[size_t(owner[next])] = film::kNoCorrespondence;
    distances[next] = distance;
    owner[next] = int32_t(i);
    correspondence.pixel[i] = there;
    correspondence.off_centre[i] = off_centre(region, next, film);
  }
  for (size_t i = 0; i < pixels; ++i) {
    const int32_t there = surface.pixel[i];
    if (correspondence.pixel[i] != film::kNoCorrespondence || there == film::kNoCorrespondence ||
        owner[size_t(there)] != film::kNoCorrespondence)
      continue;
    owner[size_t(there)] = int32_t(i);
    correspondence.pixel[i] = there;
    correspondence.off_centre[i] = surface.off_centre.empty() ? Vec2(0.0f) : surface.off_centre[i];
  }
  return correspondence;
}

void lose_strayed_chains(const CentreView& from, const CentreView& to, ChainMotion* motion) {
  if (GRADUS_FAULT(strayed_chains_kept)) return;
  const std::vector<uint32_t> instances = matching_instances(*from.snapshot, *to.snapshot);
  for (size_t i = 0; i < motion->film.size(); ++i) {
    if (motion->tracking[i] != Tracking::Tracked || !from.hits[i].valid()) continue;
    const int32_t there = pixel_at(from.region, motion->film[i]);
    if (there == film::kNoCorrespondence) continue;
    const bool shows = to.hits[size_t(there)].instance == instances[from.hits[i].instance];
    if (!shows || (is_at_edge(to, size_t(there)) && !is_at_edge(from, i))) motion->tracking[i] = Tracking::Occluded;
  }
}

film::PixelCorrespondence match_dominant(film::PixelCorrespondence surface, const Region& region,
                                         const ChainMotion& motion) {
  for (size_t i = 0; i < surface.pixel.size() && !GRADUS_FAULT(crowded_chains_follow_surfaces); ++i) {
    const Tracking tracking = motion.tracking[i];
    if (tracking == Tracking::Tracked || tracking == Tracking::Occluded) surface.pixel[i] = film::kNoCorrespondence;
  }
  return match_component(surface, region, motion);
}

}  // namespace gradus::motion
