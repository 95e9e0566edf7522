// The scene and the settings in the form that paths need, shared by all samples of a render.
#pragma once

#include <algorithm>

#include "camera/camera.h"
#include "camera/film_filter.h"
#include "film/film.h"
#include "gradus/gradus.h"
#include "lpe/components.h"
#include "path/filter_glossy.h"
#include "path/sampler.h"
#include "scene/snapshot.h"
#include "shading/shade.h"

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
  // Maximum sum of the channels of one contribution, as Cycles clamps; infinite without a limit.
  float clamp_direct = kInfinity;
  float clamp_indirect = kInfinity;
  // At least one material may let rays pass.
  bool has_transparency = true;
  // Number of transparent surfaces that a path may pass, at least 1.
  uint32_t max_transparent = 1;
  // What a ray finds depends on the kind of the bounce that it comes from, because of visibility flags, or of a Light
  // Path node in front of an emission or a transparency, or because caustics are off.
  bool kinds_matter = false;
  // RayFlag bits of a ray behind a diffuse bounce. They leave caustics out where those are switched off.
  uint32_t diffuse_flags = 0;
  // Product of the two alphas up to which glass shows the film's background; negative if no glass does.
  float glass_limit = -1.0f;
  FilterGlossy filter_glossy;
  // Angle of a pixel's shorter side, or its share of the width of an orthographic picture.
  float pixel_angle = 0.0f;
};

// Returns the number of transparent surfaces that a path may pass. Cycles checks the limit after it has passed one, and
// before Blender 5.0 its limit was one higher.
inline uint32_t max_transparent(const GradusSettings& settings) {
  return std::max(settings.transparent_max_bounces + settings.one_more_transparent, 1u);
}

// Returns whether the ray of a path has passed all the transparent surfaces that it may pass. The path then ends with
// the emission of the next surface, as in Cycles.
inline bool is_at_transparent_limit(const PathContext& context, const shading::RayState& ray) {
  return ray.transparent_depth >= context.max_transparent;
}

// Returns the camera sample of a film position. Takes a lens point and a time only if the scene needs them.
camera::CameraSample camera_sample(const PathContext& context, const Sampler& sampler, const Vec2& film);

inline Vec2 pixel_centre(int32_t x, int32_t y) {
  return Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
}

// Returns a contribution scaled down to the clamp of direct or indirect light (as film_clamp_light in Cycles).
inline Rgb clamp_contribution(const PathContext& context, const Rgb& value, bool indirect) {
  const float limit = indirect ? context.clamp_indirect : context.clamp_direct;
  const float sum = glm::abs(value.x) + glm::abs(value.y) + glm::abs(value.z);
  return sum > limit ? value * (limit / sum) : value;
}

}  // namespace gradus::path
