#include "path/context.h"

#include <algorithm>
#include <utility>

#include "light/light_table.h"
#include "shading/material.h"
#include "shading/shade.h"

namespace gradus::path {

namespace {

// Returns the maximum sum of the channels for Blender's clamp, which is the maximum mean; 0 means no limit.
float sum_limit(float clamp) { return clamp > 0.0f ? 3.0f * clamp : kInfinity; }

// Returns whether an object is visible to some kinds of bounces and hidden from others.
bool distinguishes_kinds(uint32_t visibility) {
  return (visibility & kAllBounces) != 0 && (visibility & kAllBounces) != kAllBounces;
}

bool finds_kinds_matter(const scene::Snapshot& scene) {
  const auto any = [](const auto& list, auto&& test) { return std::any_of(list.begin(), list.end(), test); };
  return distinguishes_kinds(scene.world.visibility) ||
         any(scene.materials, [](const auto& m) { return m->depends_on_kind || m->is_diffuse_behind_diffuse; }) ||
         any(scene.instances, [](const geometry::InstanceData& i) { return distinguishes_kinds(i.visibility); }) ||
         (scene.light_table && any(scene.light_table->analytic_lights, [](const light::AnalyticLight& light) {
            return light.found_by_rays() && distinguishes_kinds(light.visibility);
          }));
}

// Returns the flags of rays behind a diffuse bounce. Caustics that no lobe makes need no flag.
uint32_t flags_of_diffuse_rays(const scene::Snapshot& scene, const GradusSettings& settings) {
  uint32_t flags = shading::kRayDiffuse | shading::kRayDiffuseAncestor;
  if (!scene.features.has_glossy) return flags;
  flags |= settings.caustics_reflective != 0 ? 0u : shading::kRayWithoutReflections;
  flags |= settings.caustics_refractive != 0 ? 0u : shading::kRayWithoutRefractions;
  return flags;
}

// Returns PathContext::pixel_angle. The window of a lens polynomial is measured on the sensor, so that it gives no
// angle.
float pixel_angle_of(const GradusCamera& camera, const GradusSettings& settings) {
  if (camera.type == GRADUS_CAMERA_PANORAMA && camera.panorama == GRADUS_PANORAMA_FISHEYE_POLYNOMIAL) return 0.0f;
  const float* w = camera.window;
  const float side = std::min((w[1] - w[0]) / static_cast<float>(std::max(settings.width, 1u)),
                              (w[3] - w[2]) / static_cast<float>(std::max(settings.height, 1u)));
  return camera.type == GRADUS_CAMERA_ORTHOGRAPHIC ? side / (w[1] - w[0]) : side;
}

// Returns PathContext::glass_limit. A roughness is the square root of an alpha.
float glass_limit_of(const GradusSettings& settings) {
  if (settings.film_transparent == 0 || settings.film_transparent_glass == 0) return -1.0f;
  const float alpha = settings.film_transparent_roughness * settings.film_transparent_roughness;
  return alpha * alpha;
}

bool finds_transparency(const scene::Snapshot& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const auto& material) { return material->may_be_transparent; });
}

}  // namespace

PathContext::PathContext(const scene::Snapshot& snapshot, const camera::Camera& camera_,
                         const GradusSettings& settings_, lpe::ComponentSet components_)
    : scene(snapshot),
      camera(camera_),
      settings(settings_),
      components(std::move(components_)),
      filter(settings_.pixel_filter, settings_.filter_width),
      clamp_direct(sum_limit(settings_.clamp_direct)),
      clamp_indirect(sum_limit(settings_.clamp_indirect)),
      has_transparency(finds_transparency(snapshot)),
      max_transparent(path::max_transparent(settings_)),
      kinds_matter(finds_kinds_matter(snapshot)),
      diffuse_flags(flags_of_diffuse_rays(snapshot, settings_)),
      glass_limit(glass_limit_of(settings_)),
      filter_glossy(snapshot.features.min_alpha < FilterGlossy::kMaxBlur ? settings_.blur_glossy : 0.0f),
      pixel_angle(pixel_angle_of(snapshot.camera, settings_)) {
  kinds_matter |= (diffuse_flags & (shading::kRayWithoutReflections | shading::kRayWithoutRefractions)) != 0;
}

camera::CameraSample camera_sample(const PathContext& context, const Sampler& sampler, const Vec2& film) {
  camera::CameraSample sample{film};
  if (context.camera.has_lens()) sample.lens = sampler.get2(dimension::kLens);
  if (context.scene.features.has_motion) sample.time = context.scene.shutter.sample(sampler.get1(dimension::kTime));
  return sample;
}

}  // namespace gradus::path
