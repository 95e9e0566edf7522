// What all samples of a render share: the scene and the settings in the form in which paths need them.
#pragma once

#include "camera/camera.h"
#include "camera/film_filter.h"
#include "film/film.h"
#include "gradus/gradus.h"
#include "lpe/components.h"
#include "path/sampler.h"
#include "scene/snapshot.h"

namespace gradus::path {

// GradusVisibility bits of all kinds of bounces.
inline constexpr uint32_t kAllBounces = GRADUS_VISIBLE_DIFFUSE | GRADUS_VISIBLE_GLOSSY | GRADUS_VISIBLE_TRANSMISSION;

struct PathContext {
  PathContext(const scene::Snapshot& snapshot, const camera::Camera& camera, const GradusSettings& settings,
              lpe::ComponentSet components = {});

  const scene::Snapshot& scene;
  const camera::Camera& camera;
  const GradusSettings& settings;
  const lpe::ComponentSet components;
  camera::FilmFilter filter;
  // Bounds on the sum of the channels of one contribution (infinite: none), as Cycles clamps.
  float clamp_direct = kInfinity;
  float clamp_indirect = kInfinity;
  // Some surface may let rays go straight on.
  bool has_transparency = true;
  // All surfaces look the same to every kind of bounce and to shadow rays, so that a shadow ray answers for a path
  // segment.
  bool uniform_visibility = true;
  // What a ray finds depends on the kind of bounce that it comes from: on visibility to kinds of rays, or on a Light
  // Path node in front of an emission or a transparency.
  bool kinds_matter = false;
};

// Lens and time of a sample, where the scene asks for them.
camera::CameraSample camera_sample(const PathContext& context, const Sampler& sampler, const Vec2& film);

inline Vec2 pixel_centre(int32_t x, int32_t y) {
  return Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
}

// A contribution, clamped by the rule of its kind; keeps the hue (Cycles' film_clamp_light; a user's value bounds the
// channels' mean).
inline Rgb clamp_contribution(const PathContext& context, const Rgb& value, bool indirect) {
  const float limit = indirect ? context.clamp_indirect : context.clamp_direct;
  const float sum = glm::abs(value.x) + glm::abs(value.y) + glm::abs(value.z);
  return sum > limit ? value * (limit / sum) : value;
}

}  // namespace gradus::path
