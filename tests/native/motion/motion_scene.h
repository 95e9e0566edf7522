// Two frames of a small scene, what a component shows in them, and the truth about where it went.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "motion/snapshot_motion.h"
#include "motion/specular_motion.h"
#include "support/path_scene.h"

namespace gradus::test {

// A frame seen by a component.
struct MotionFrame {
  IntegratorContext context;
  CentreView centres;
  ChainView chains;
};

inline std::unique_ptr<MotionFrame> motion_frame(const IntegratorContext& context, const ComponentSet& components, const char* name) {
  auto frame = std::make_unique<MotionFrame>();
  frame->context = context;
  const GradusSettings& s = frame->context.settings;
  const Region region{0, 0, int32_t(s.width), int32_t(s.height)};
  frame->centres = view_centres(*frame->context.snapshot, s.width, s.height, region);
  const int component = components.find(name);
  EXPECT_GE(component, 0) << name;
  frame->chains = view_chains(frame->centres, s, components, 1u << component).at(0);
  return frame;
}

// Angle between a way's last ray from a place of the film and the line to the target; infinite where the way breaks.
inline double angle_to(const ChainTracer& tracer, const ChainWay& way, const Target& target, const glm::dvec2& film) {
  SpecularChain chain;
  if (!tracer.follow(Vec2(film), way, &chain)) return 1e9;
  const glm::dvec3 line(target.in_sky ? target.place : target.place - chain.ray.ray.origin);
  const glm::dvec3 direction(chain.ray.ray.direction);
  return std::atan2(glm::length(glm::cross(line, direction)), glm::dot(line, direction));
}

// The place of the film within `reach` pixels of `around` that shows the target best, by trying them all and then around the best ever
// more finely.
inline glm::dvec2 brute_force(const ChainTracer& tracer, const ChainWay& way, const Target& target, const glm::dvec2& around, double reach,
                              double finest) {
  glm::dvec2 best(around);
  double least = 1e9;
  // True: a better one was found.
  const auto look = [&](const glm::dvec2 centre, double half, double step) {
    const double before = least;
    for (double y = -half; y <= half + 1e-9; y += step)
      for (double x = -half; x <= half + 1e-9; x += step) {
        const double angle = angle_to(tracer, way, target, centre + glm::dvec2(x, y));
        if (angle < least) least = angle, best = centre + glm::dvec2(x, y);
      }
    return least < before;
  };
  look(best, reach, 0.25 * reach);
  for (double step = 0.125 * reach; step > finest; step *= 0.5)
    while (look(best, step, step)) continue;
  return best;
}

// Whether that place really shows the target: nothing stands before it.
inline bool shows(const ChainTracer& tracer, const ChainWay& way, const Target& target, const glm::dvec2& film, double radians = 1e-4) {
  SpecularChain chain;
  Hit hit;
  if (angle_to(tracer, way, target, film) > radians || !tracer.follow(Vec2(film), way, &chain)) return false;
  const bool met = tracer.finish(chain, &hit);
  return target.in_sky ? !met : met && hit.t > 0.999f * glm::length(target.place - chain.ray.ray.origin);
}

struct MotionErrors {
  size_t pixels = 0;          // whose motion exists
  size_t tracked = 0;         // of them
  size_t invented = 0;        // tracked to where it is not to be seen
  std::vector<float> errors;  // of those tracked, in pixels

  float share() const { return pixels > 0 ? float(tracked) / float(pixels) : 0.0f; }
  float quantile(double q) const {
    if (errors.empty()) return kInfinity;
    std::vector<float> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1, size_t(q * double(sorted.size())))];
  }
};

// Where a chain's end is in another frame. False: nowhere.
inline bool find_target(const MotionFrame& from, const MotionFrame& to, const SpecularChain& chain, Target* target) {
  *target = {chain.ray.ray.direction, chain.end == ChainEnd::Sky};
  return target->in_sky || SnapshotMotion(*from.context.snapshot, *to.context.snapshot).position(chain.last, &target->place);
}

// Whether a place of the film of `to` shows what a chain of `from` does.
inline bool shows_in(const MotionFrame& to, const MotionFrame& from, const SpecularChain& chain, const Vec2& film) {
  Target target;
  return find_target(from, to, chain, &target) && shows(to.chains.tracer(), chain.way, target, glm::dvec2(film), 3e-4);
}

// The truth about a pixel: what it shows is followed through frames in between, by brute force about the place in the one before. False: it
// is lost on the way, because it ceases or comes out of nowhere.
inline bool true_place(const std::vector<const MotionFrame*>& frames, const SpecularChain& chain, const Vec2& centre, glm::dvec2* place) {
  constexpr double kFarthest = 0.5, kFinest = 2e-5;  // pixels from one to the next
  *place = glm::dvec2(centre);
  for (size_t k = 1; k < frames.size(); ++k) {
    const ChainTracer tracer = frames[k]->chains.tracer();
    Target target;
    if (!find_target(*frames[0], *frames[k], chain, &target)) return false;
    *place = brute_force(tracer, chain.way, target, *place, kFarthest, kFinest);
    if (!shows(tracer, chain.way, target, *place)) return false;
  }
  return true;
}

// Against the truth, at every `stride`th pixel with a chain.
inline MotionErrors errors_of(const ChainMotion& motion, const std::vector<const MotionFrame*>& frames, size_t stride) {
  MotionErrors errors;
  const ChainView& view = frames[0]->chains;
  const auto width = size_t(view.region().width());
  size_t number = 0;
  for (size_t i = 0; i < motion.film.size(); ++i) {
    const int32_t index = view.places[i];
    EXPECT_TRUE(index >= 0 || motion.tracking[i] == Tracking::NoPath);
    if (index < 0 || number++ % stride != 0) continue;
    const Vec2 centre(float(i % width) + 0.5f, float(i / width) + 0.5f);
    const bool tracked = motion.tracking[i] == Tracking::Tracked;
    glm::dvec2 truth;
    const bool exists = true_place(frames, view.chains[size_t(index)], centre, &truth);
    const double error = glm::length(truth - glm::dvec2(motion.film[i]));
    errors.pixels += exists;
    errors.tracked += exists && tracked;
    errors.invented += tracked && !shows_in(*frames.back(), *frames[0], view.chains[size_t(index)], motion.film[i]);
    if (exists && tracked) errors.errors.push_back(float(error));
  }
  return errors;
}

// A wavy sheet over [-1, 1]² in x and y, smooth, with a UV map.
struct Sheet {
  int cells = 48;
  float height = 0.0f;  // of waves along x and y
  float phase = 0.0f;
  bool smooth = true;
  bool has_uv = true;
};
// later: how it is shaped one frame later, and as much the other way one frame before; nullptr: it keeps its shape.
void set_sheet(PathScene* scene, uint64_t mesh_key, const Sheet& sheet, const Sheet* before = nullptr, const Sheet* later = nullptr);
// A mirror whose normals wave by `tilt`, by a normal map over the default UV map, or by a bump.
uint64_t normal_mapped_mirror(PathScene* scene, float tilt, float waves);
uint64_t bumped_mirror(PathScene* scene, float distance);

// Frames one after the other, and the bars that their motion must pass.
class MotionTest : public testing::Test {
 protected:
  static constexpr int kSize = 48;

  uint64_t mirror() { return scene_.material(glossy(0.0f)); }
  uint64_t grey() { return scene_.material(matte(Rgb(0.5f))); }
  uint64_t clear() { return scene_.material(glass(0.0f)); }
  // A floor at y = -1 and walls before and behind.
  void add_room();
  // What was built up to now, as a frame.
  const MotionFrame* frame(const char* component);
  static ChainMotion motion(const MotionFrame* from, const MotionFrame* to) {
    return track_chains(from->chains, to->chains.tracer(), from->chains.region());
  }
  // Moves the scene from 0 to 1; the motion of the component must pass the bars of issue 7 against the truth. Gives the motion.
  ChainMotion expect_motion(const char* component, const std::function<void(float)>& at);
  // Whatever happens: every motion is finite and bounded by the film, and what is not tracked does not move.
  static void expect_bounded(const ChainMotion& motion);

  ComponentSet components_ = ComponentSet::parse("");
  PathScene scene_;
  std::vector<std::unique_ptr<MotionFrame>> frames_;
};

}  // namespace gradus::test
