#include "motion_check.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "motion/true_motion.h"
#include "scene/moved_snapshot.h"

namespace gradus::tool {

using nlohmann::ordered_json;

ordered_json Distances::json() {
  std::sort(pixels_.begin(), pixels_.end());
  const auto quantile = [&](double q) {
    return pixels_[std::min(pixels_.size() - 1, size_t(q * double(pixels_.size())))];
  };
  if (pixels_.empty()) return {{"pixels", 0}};
  return {{"pixels", pixels_.size()}, {"median", quantile(0.5)}, {"quantile_95", quantile(0.95)}};
}

void SimplerMotion::add(const motion::SpecularChain& chain, const Vec2& place) {
  const camera::Camera& camera = next_.camera();
  Vec2 film;
  Vec3 position;
  if (surface_.position(chain.first, &position) && camera.project(position, Moment::Now, &film))
    first_.add(glm::length(camera.film_displacement(place, film)));
  if (motion::flat_mirror_motion(here_, next_, surface_, chain, motion::FlatMirror::Static, &film))
    static_mirror_.add(glm::length(camera.film_displacement(place, film)));
  if (motion::flat_mirror_motion(here_, next_, surface_, chain, motion::FlatMirror::MovesAlong, &film))
    along_.add(glm::length(camera.film_displacement(place, film)));
}

StepsBetween::Film::Film(std::shared_ptr<const scene::Snapshot> s, const GradusSettings& settings)
    : snapshot(std::move(s)),
      camera(camera::Camera(snapshot->camera, settings.width, settings.height).without_lens()),
      tracer(*snapshot, camera, settings) {}

StepsBetween::StepsBetween(const scene::Snapshot& snapshot, const GradusSettings& settings, double farthest)
    : farthest_(farthest) {
  constexpr double kStep = 0.3, kMin = 8.0, kMax = 128.0;  // pixels in one step: less than true_place() looks for
  const auto count = int(std::clamp(std::ceil(farthest / kStep), kMin, kMax));
  const auto never = [] { return false; };
  for (int k = 1; k <= count; ++k)
    frames_.push_back(std::make_unique<Film>(
        scene::moved_snapshot(snapshot, Moment::Next, never, k == count ? 1.0f : float(k) / float(count)), settings));
}

namespace {

struct Pixel {
  size_t number;
  const motion::SpecularChain* chain;
  bool exists = false;     // Its content is visible through all steps.
  bool reappears = false;  // Its content is hidden in between, but visible in the last step.
  bool invented = false;   // It was tracked to a place where its content is not visible.
  glm::dvec2 truth{0.0};
};

std::vector<Pixel> spread(const motion::ChainView& view, size_t wanted) {
  std::vector<Pixel> all, chosen;
  for (size_t i = 0; i < view.places.size(); ++i)
    if (view.places[i] >= 0 && !view.chains[size_t(view.places[i])].is_static)
      all.push_back({i, &view.chains[size_t(view.places[i])]});
  const size_t stride = std::max<size_t>(1, all.size() / std::max<size_t>(wanted, 1));
  for (size_t i = stride / 2; i < all.size(); i += stride) chosen.push_back(all[i]);
  return chosen;
}

}  // namespace

ordered_json StepsBetween::check(const motion::ChainView& view, const motion::ChainMotion& found, size_t wanted) const {
  constexpr double kSameThing = 3e-4;           // radians
  constexpr double kBeside = 2.0, kMax = 24.0;  // pixels
  const double reach = std::min(farthest_ + kBeside, kMax);
  const motion::ChainTracer here = view.tracer();
  std::vector<const motion::ChainTracer*> tracers{&here};
  for (const auto& frame : frames_) tracers.push_back(&frame->tracer);
  const motion::ChainTracer& next = *tracers.back();
  std::vector<Pixel> pixels = spread(view, wanted);
  const auto width = size_t(view.region().width());
  const auto is_tracked = [&](const Pixel& p) { return found.tracking[p.number] == motion::Tracking::Tracked; };
  tbb::parallel_for(size_t{0}, pixels.size(), [&](size_t i) {
    Pixel& p = pixels[i];
    const Vec2 centre = path::pixel_centre(int32_t(p.number % width), int32_t(p.number / width));
    p.exists = motion::true_place(tracers, *p.chain, centre, &p.truth);
    motion::Target target;
    const bool is_there = motion::true_target(here, next, *p.chain, &target);
    p.reappears = !p.exists && is_there && motion::seen_near(next, p.chain->signature, target, centre, reach);
    p.invented = is_tracked(p) && !(is_there && motion::shows(next, p.chain->signature, target,
                                                              glm::dvec2(found.film[p.number]), kSameThing));
  });
  size_t exist = 0, reappear = 0, tracked = 0, invented = 0;
  Distances errors;
  SimplerMotion simpler(here, next);
  for (const Pixel& p : pixels) {
    exist += p.exists;
    reappear += p.reappears;
    invented += p.invented;
    if (!p.exists) continue;
    if (p.chain->signature.length > 0) simpler.add(*p.chain, Vec2(p.truth));
    if (!is_tracked(p)) continue;
    ++tracked;
    errors.add(glm::length(glm::dvec2(next.camera().film_displacement(found.film[p.number], Vec2(p.truth)))));
  }
  return {{"steps", frames_.size()}, {"searched", pixels.size()}, {"exist", exist},
          {"reappear", reappear},    {"tracked", tracked},        {"invented", invented},
          {"error", errors.json()},  {"simpler", simpler.json()}};
}

double farthest_displacement(const motion::ChainTracer& next, const std::vector<motion::ChainView>& views,
                             const std::vector<motion::ChainMotion>& found) {
  constexpr double kQuantile = 0.99;
  std::vector<float> displacements;
  const auto add = [&](const Vec2& from, const Vec2& to) {
    displacements.push_back(glm::length(next.camera().film_displacement(from, to)));
  };
  for (size_t c = 0; c < found.size(); ++c) {
    const motion::ChainView& view = views[c];
    const motion::ChainTracer here = view.tracer();
    const motion::SnapshotMotion surface(here.snapshot(), next.snapshot());
    for (size_t i = 0; i < found[c].film.size(); ++i) {
      if (view.places[i] < 0) continue;
      const motion::SpecularChain& chain = view.chains[size_t(view.places[i])];
      if (chain.is_static) continue;
      const auto width = size_t(view.region().width());
      const Vec2 centre = path::pixel_centre(int32_t(i % width), int32_t(i / width));
      if (found[c].tracking[i] == motion::Tracking::Tracked) add(centre, found[c].film[i]);
      const geometry::Hit& seen = chain.signature.length > 0 ? chain.first : chain.last;
      Vec3 position;
      Vec2 film;
      if (seen.valid() && surface.position(seen, &position) && next.camera().project(position, Moment::Now, &film))
        add(centre, film);
    }
  }
  if (displacements.empty()) return 0.0;
  const auto fast = displacements.begin() + ptrdiff_t(kQuantile * double(displacements.size() - 1));
  std::nth_element(displacements.begin(), fast, displacements.end());
  return double(*fast);
}

}  // namespace gradus::tool
