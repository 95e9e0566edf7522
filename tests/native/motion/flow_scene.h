// Two frames of a film whose motion is known by formula: lit surfaces that move, and shadows that move otherwise.
#pragma once

#include <functional>
#include <memory>

#include "motion/irradiance_motion.h"

namespace gradus {

struct FlowSample {
  float light = 1.0f;
  int32_t object = 1;
  float depth = 10.0f;
};

struct FlowScene {
  int width = 160, height = 120;
  std::function<FlowSample(const Vec2& place, int frame)> sample;
  std::function<Vec2(const Vec2& place, int32_t object)> surface = [](const Vec2&, int32_t) {
    return Vec2(0.0f);
  };                   // of frame 0; with the other value: back
  float noise = 0.0f;  // standard deviation, as a share of the light
};

// The planes of a frame; each pixel is the mean of 4 × 4 points.
class FlowFilm {
 public:
  FlowFilm(const FlowScene& scene, int frame);
  motion::ComponentFrame view() const { return {light, surface, tracked, object, depth}; }

  std::vector<Rgb> light;
  std::vector<Vec2> surface;
  std::vector<float> tracked, depth;
  std::vector<int32_t> object;
};

// Returns a smooth pattern that differs everywhere.
float flow_pattern(const Vec2& place);
// Returns 1 in the light and `dark` in the shadow of a disc, with a transition of about four times `softness` pixels.
float disc_shadow(const Vec2& place, const Vec2& centre, float radius, float softness, float dark = 0.12f);
// Rotates `place` around `centre`, by degrees.
Vec2 turned(const Vec2& place, const Vec2& centre, float degrees);

std::shared_ptr<const motion::FlowLibrary> flow_library_of_the_build();
std::array<motion::PixelMotion, 2> motion_of(const FlowScene& scene,
                                             motion::FlowDomain domain = motion::FlowDomain::Logarithmic);

// Returns the quantile: `share` of the values are no larger.
float quantile(std::vector<float> values, float share);

}  // namespace gradus
