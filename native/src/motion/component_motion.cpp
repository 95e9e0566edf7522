#include "motion/component_motion.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "base/error.h"
#include "base/hash.h"
#include "path/context.h"
#include "scene/moved_snapshot.h"

namespace gradus::motion {

namespace {

// The scene at the previous or the next frame, with a camera and a chain tracer.
struct OtherFrame {
  OtherFrame(const scene::Snapshot& scene, Moment when, const GradusSettings& settings, const CancelCheck& is_cancelled)
      : snapshot(scene::moved_snapshot(scene, when, is_cancelled)),
        camera(camera::Camera(snapshot->camera, settings.width, settings.height).without_lens()),
        tracer(*snapshot, camera, settings) {}
  OtherFrame(const OtherFrame&) = delete;

  std::shared_ptr<const scene::Snapshot> snapshot;
  camera::Camera camera;
  ChainTracer tracer;
};

static_assert(float(Tracking::NoPath) == film::kNothingToTrack, "planes of motion are initialised with NoPath");

// Returns the band with a border of one pixel: chain_jacobian() needs the chains of neighbouring pixels.
Region with_neighbours(const Region& band, const GradusSettings& settings) {
  return {std::max(band.x0 - 1, 0), std::max(band.y0 - 1, 0), std::min(band.x1 + 1, int32_t(settings.width)),
          std::min(band.y1 + 1, int32_t(settings.height))};
}

// Returns the motion of each view. has_surfaces: whether the last view is view_surfaces(); its motion is then used for
// everything that other views show directly.
std::vector<ChainMotion> track_views(const std::vector<ChainView>& views, bool has_surfaces, const ChainTracer& to,
                                     const Region& band, const CancelCheck& is_cancelled) {
  std::vector<ChainMotion> motion(views.size());
  if (has_surfaces) motion.back() = track_chains(views.back(), to, band, is_cancelled);
  const KnownMotion surfaces{views.back(), motion.back()};
  const size_t others = views.size() - (has_surfaces ? 1 : 0);
  for (size_t k = 0; k < others; ++k)
    motion[k] = track_chains(views[k], to, band, is_cancelled, has_surfaces ? &surfaces : nullptr);
  return motion;
}

// Writes the motion of a band to both frames. pixel: index of the first pixel of the band in `joined`.
void join(const camera::Camera& camera, const Region& band, const ChainMotion& previous, const ChainMotion& next,
          size_t pixel, ComponentMotion* joined) {
  const auto width = size_t(band.width());
  joined->counts.add(previous.counts);
  joined->counts.add(next.counts);
  for (size_t i = 0; i < previous.film.size(); ++i, ++pixel) {
    const Tracking tracking = previous.tracking[i] != Tracking::Tracked ? previous.tracking[i] : next.tracking[i];
    joined->tracked[pixel] = float(tracking);
    if (tracking != Tracking::Tracked) continue;
    const Vec2 now = path::pixel_centre(band.x0 + int32_t(i % width), band.y0 + int32_t(i / width));
    joined->vectors[pixel] =
        Vec4(camera.film_displacement(now, previous.film[i]), camera.film_displacement(next.film[i], now));
  }
}

constexpr uint64_t kNumbers = uint64_t{1} << 24;  // count of integers that a float represents exactly

// Returns a number, 1 or larger, for the specular signature of a chain and the object at its end. It is the same in all
// frames.
float number_of(const scene::Snapshot& snapshot, const SpecularChain& chain) {
  const uint64_t end = chain.last.valid() ? snapshot.instances[chain.last.instance].id + 1 : 0;
  const uint64_t hash =
      mix_bits(mix_bits(chain.signature.surfaces + 5 * chain.signature.events + chain.signature.length) + 3 * end +
               uint64_t(chain.end));
  return float(1 + hash % (kNumbers - 1));
}

// Writes what the chains of a band show. shown: points to the entry of the band's first pixel.
void write_shown_points(const ChainView& view, const Region& band, film::ShownPoint* shown) {
  for (int32_t y = band.y0; y < band.y1; ++y) {
    for (int32_t x = band.x0; x < band.x1; ++x, ++shown) {
      const SpecularChain* chain = view.at(x, y);
      if (chain) *shown = {number_of(*view.centres->snapshot, *chain), chain->length};
    }
  }
}

}  // namespace

std::vector<ComponentMotion> component_motion(const scene::Snapshot& snapshot, const GradusSettings& settings,
                                              const lpe::ComponentSet& components, uint32_t wanted,
                                              const Region& region, const CancelCheck& is_cancelled) {
  const auto pixels = size_t(region.area()), width = size_t(region.width());
  const uint32_t residual = components.residual();
  wanted &= components.all();
  std::vector<ComponentMotion> motion(
      size_t(std::popcount(wanted)),
      {std::vector<Vec4>(pixels, Vec4(0.0f)), std::vector<float>(pixels), std::vector<film::ShownPoint>(pixels), {}});
  if (wanted == 0) return motion;
  const OtherFrame previous(snapshot, Moment::Previous, settings, is_cancelled),
      next(snapshot, Moment::Next, settings, is_cancelled);
  Change change(snapshot);
  for (const OtherFrame* other : {&previous, &next}) change.add(*other->snapshot);
  for (int32_t y = region.y0; y < region.y1; y += kTrackingBand) {
    const Region band{region.x0, y, region.x1, std::min(y + kTrackingBand, region.y1)};
    const CentreView centres =
        view_centres(snapshot, settings.width, settings.height, with_neighbours(band, settings), is_cancelled);
    std::vector<ChainView> views =
        view_chains(centres, settings, components, wanted & ~residual, is_cancelled, &change);
    const bool has_surfaces = (wanted & residual) != 0;
    if (has_surfaces) views.push_back(view_surfaces(centres, settings, &change));
    const auto before = track_views(views, has_surfaces, previous.tracer, band, is_cancelled),
               after = track_views(views, has_surfaces, next.tracer, band, is_cancelled);
    for (size_t k = 0; k < views.size(); ++k) {
      const size_t first = width * size_t(y - region.y0);
      join(centres.camera, band, before[k], after[k], first, &motion[k]);
      write_shown_points(views[k], band, &motion[k].shown[first]);
    }
    if (is_cancelled()) throw cancelled();
  }
  return motion;
}

}  // namespace gradus::motion
