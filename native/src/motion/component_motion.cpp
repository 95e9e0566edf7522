#include "motion/component_motion.h"

#include <memory>

#include "base/error.h"
#include "path/context.h"
#include "scene/moved_snapshot.h"

namespace gradus {

namespace {

// Another moment of the scene.
struct OtherFrame {
  OtherFrame(const Snapshot& scene, Moment when, const GradusSettings& settings, const CancelTest& is_cancelled)
      : snapshot(moved_snapshot(scene, when, is_cancelled)),
        camera(Camera(snapshot->camera, settings.width, settings.height).without_lens()),
        tracer(*snapshot, camera, settings) {}
  OtherFrame(const OtherFrame&) = delete;

  std::shared_ptr<const Snapshot> snapshot;
  Camera camera;
  ChainTracer tracer;
};

ComponentMotion join(const ChainView& view, const ChainMotion& previous, const ChainMotion& next) {
  const Region& region = view.region();
  const auto width = size_t(region.width()), pixels = size_t(region.area());
  const Camera& camera = view.centres->camera;
  ComponentMotion joined{std::vector<Vec4>(pixels, Vec4(0.0f)), std::vector<float>(pixels), previous.counts};
  joined.counts.add(next.counts);
  for (size_t i = 0; i < pixels; ++i) {
    const Tracking tracking = previous.tracking[i] != Tracking::Tracked ? previous.tracking[i] : next.tracking[i];
    joined.tracked[i] = float(tracking);
    if (tracking != Tracking::Tracked) continue;
    const Vec2 now = pixel_centre(region.x0 + int32_t(i % width), region.y0 + int32_t(i / width));
    joined.vectors[i] = Vec4(camera.way(now, previous.film[i]), camera.way(next.film[i], now));
  }
  return joined;
}

}  // namespace

std::vector<ComponentMotion> component_motion(const Snapshot& snapshot, const GradusSettings& settings, const ComponentSet& components,
                                              uint32_t wanted, const Region& region, const CancelTest& is_cancelled) {
  std::vector<ComponentMotion> motion;
  if (wanted == 0) return motion;
  const CentreView centres = view_centres(snapshot, settings.width, settings.height, region, is_cancelled);
  const OtherFrame previous(snapshot, Moment::Previous, settings, is_cancelled), next(snapshot, Moment::Next, settings, is_cancelled);
  for (int c = 0; c < components.count(); ++c) {
    if ((wanted >> c & 1) == 0) continue;
    const ChainView view = view_chains(centres, settings, components, c, is_cancelled);
    motion.push_back(join(view, track_chains(view, previous.tracer, is_cancelled), track_chains(view, next.tracer, is_cancelled)));
    if (is_cancelled()) throw cancelled();
  }
  return motion;
}

}  // namespace gradus
