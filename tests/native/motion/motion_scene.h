// Two frames of a small scene, what a component shows in them, and the true motion of it.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "motion/specular_motion.h"
#include "motion/true_motion.h"
#include "support/path_scene.h"

namespace gradus::test {

// A frame and the chains of a component in it.
struct MotionFrame {
  integrator::IntegratorContext context;
  motion::CentreView centres;
  motion::ChainView chains;
};

inline std::unique_ptr<MotionFrame> motion_frame(const integrator::IntegratorContext& context,
                                                 const lpe::ComponentSet& components, const char* name) {
  auto frame = std::make_unique<MotionFrame>();
  frame->context = context;
  const GradusSettings& s = frame->context.settings;
  const Region region{0, 0, int32_t(s.width), int32_t(s.height)};
  frame->centres = motion::view_centres(*frame->context.snapshot, s.width, s.height, region);
  const int component = components.find(name);
  EXPECT_GE(component, 0) << name;
  frame->chains = motion::view_chains(frame->centres, s, components, 1u << component).at(0);
  return frame;
}

struct MotionErrors {
  size_t pixels = 0;          // with known motion
  size_t tracked = 0;         // number of those that are tracked
  size_t invented = 0;        // tracked to where the object is not visible
  std::vector<float> errors;  // of the tracked pixels, in pixels

  float share() const { return pixels > 0 ? float(tracked) / float(pixels) : 0.0f; }
  float quantile(double q) const {
    if (errors.empty()) return kInfinity;
    std::vector<float> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1, size_t(q * double(sorted.size())))];
  }
};

// Returns whether a position on the film of `to` shows what a chain of `from` shows.
inline bool shows_in(const MotionFrame& to, const MotionFrame& from, const motion::SpecularChain& chain,
                     const Vec2& film) {
  const motion::ChainTracer here = from.chains.tracer(), there = to.chains.tracer();
  motion::Target target;
  return motion::true_target(here, there, chain, &target) &&
         motion::shows(there, chain.signature, target, glm::dvec2(film), 3e-4);
}

// Compares with the truth at every `stride`th pixel with a chain.
inline MotionErrors errors_of(const motion::ChainMotion& motion, const std::vector<const MotionFrame*>& frames,
                              size_t stride) {
  MotionErrors errors;
  const motion::ChainView& view = frames[0]->chains;
  std::vector<motion::ChainTracer> tracers;
  for (const MotionFrame* frame : frames) tracers.push_back(frame->chains.tracer());
  std::vector<const motion::ChainTracer*> path;
  for (const motion::ChainTracer& tracer : tracers) path.push_back(&tracer);
  const auto width = size_t(view.region().width());
  size_t number = 0;
  for (size_t i = 0; i < motion.film.size(); ++i) {
    const int32_t index = view.places[i];
    EXPECT_TRUE(index >= 0 || motion.tracking[i] == motion::Tracking::NoPath);
    if (index < 0 || number++ % stride != 0) continue;
    const Vec2 centre(float(i % width) + 0.5f, float(i / width) + 0.5f);
    const bool tracked = motion.tracking[i] == motion::Tracking::Tracked;
    glm::dvec2 truth;
    const bool exists = motion::true_place(path, view.chains[size_t(index)], centre, &truth);
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
// later: the shape one frame later; the shape one frame before deviates by as much the other way; nullptr: a constant
// shape.
void set_sheet(PathScene* scene, uint64_t mesh_key, const Sheet& sheet, const Sheet* before = nullptr,
               const Sheet* later = nullptr);
// A mirror whose normals vary by `tilt`, through a normal map over the default UV map, or through a bump map.
uint64_t normal_mapped_mirror(PathScene* scene, float tilt, float waves);
uint64_t bumped_mirror(PathScene* scene, float distance);

// Consecutive frames, and the error bounds for their motion.
class MotionTest : public testing::Test {
 protected:
  static constexpr int kSize = 48;

  uint64_t mirror() { return scene_.material(glossy(0.0f)); }
  uint64_t grey() { return scene_.material(matte(Rgb(0.5f))); }
  uint64_t clear() { return scene_.material(glass(0.0f)); }
  // Adds a floor at y = -1, and walls in front and behind.
  void add_room();
  // Adds the room with a ball in its middle, instance 3, and a camera in front of it.
  void add_ball(uint64_t material, int rings = 32, bool smooth = true);
  // Returns the scene as built so far, as a frame.
  const MotionFrame* frame(const char* component);
  static motion::ChainMotion motion(const MotionFrame* from, const MotionFrame* to) {
    return motion::track_chains(from->chains, to->chains.tracer(), from->chains.region());
  }
  // Moves the scene from 0 to 1 and compares the motion of the component with the truth. Returns the motion.
  motion::ChainMotion expect_motion(const char* component, const std::function<void(float)>& at);
  // Expects every motion to be finite and bounded by the film, and that of untracked pixels to be 0.
  static void expect_bounded(const motion::ChainMotion& motion);

  lpe::ComponentSet components_ = lpe::ComponentSet::parse("");
  PathScene scene_;
  std::vector<std::unique_ptr<MotionFrame>> frames_;
};

}  // namespace gradus::test
