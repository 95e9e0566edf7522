#include "shading/shade.h"

#include "shading/closure_tape.h"
#include "shading/context.h"
#include "shading/displacement.h"
#include "shading/interpreter.h"
#include "shading/material.h"

namespace gradus::shading {
namespace {

const MaterialData& material_of(const ShadedScene& scene, uint32_t index) {
  return *scene.materials[index < scene.materials.size() ? index : 0];
}

// Returns the context of a surface point. If `bumps`, it has the normal that the material displaces, which takes three
// evaluations of the displacement: programs that do not read the normal go without.
ShadeContext context_of(const MaterialData& material, bool bumps, const ShadedScene& scene,
                        const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray) {
  ShadeContext c = surface_context(scene, point, wo, ray);
  if (bumps) c.normal = displacement_bump(material, c);
  return c;
}

void clear(ShadeResult* result) {
  result->closures.clear();
  result->emission = result->transparency = result->holdout = result->portal.weight = Rgb(0.0f);
  result->fallback = result->is_faulty = result->complete = result->ignores_wo = false;
  if (result->tape) result->tape->clear();
}

// Runs a program of the context's material.
void run_noting_faults(const Program& program, const ShadeContext& context, ShadeResult* result) {
  run_program(program, context, result);
  if (result->is_faulty) note_fault(context);
}

// Finishes the closures of a result after all have been added.
void complete(const ShadedScene& scene, const MaterialData& material, const geometry::SurfacePoint& point,
              const Vec3& geometric_normal, const Vec3& normal, const Vec3& wo, const RayState& ray,
              float roughness_threshold, ShadeResult* result) {
  result->closures.set_terminator_frequency(point.terminator_frequency);
  result->closures.set_shading_normals(material.shading_normals);
  result->closures.finish(wo, geometric_normal, roughness_threshold, normal, ray.blur);
  result->ignores_wo = !material.values_depend_on_ray && result->closures.ignores_wo();
  result->complete = true;
  if (!scene.guiding || !result->closures.has_smooth(bsdf::ScatterClass::Diffuse)) return;
  if (const guide::Guide* guide = scene.guiding->at(point.position, geometric_normal); guide != nullptr)
    result->closures.guide_by(*guide, point.position, guide::guided_probability(ray.guided_ratio));
}

// A fast path for materials with is_lambert. The result is that of their program.
void shade_lambert(const ShadedScene& scene, const MaterialData& material, const geometry::SurfacePoint& point,
                   const Vec3& wo, const RayState& ray, float roughness_threshold, ShadeResult* result) {
  bsdf::Lobe* lobe = result->closures.add();
  *lobe = material.lambert;
  lobe->normal = point.shading_normal;
  const bool backfacing = glm::dot(point.geometric_normal, wo) < 0.0f;
  complete(scene, material, point, backfacing ? -point.geometric_normal : point.geometric_normal,
           backfacing ? -point.shading_normal : point.shading_normal, wo, ray, roughness_threshold, result);
}

// Returns a cleared temporary result for programs whose closures are not needed. It is large, so each thread keeps one.
ShadeResult* scratch() {
  thread_local ShadeResult result;
  clear(&result);
  return &result;
}

Rgb emission_of(const MaterialData& material, const ShadeContext& context) {
  if (!material.emits) return Rgb(0.0f);
  if (material.emission_is_constant) return material.constant_emission;
  ShadeResult* result = scratch();
  run_noting_faults(material.emission, context, result);
  return result->emission;
}

// Returns the outputs to AOVs of a material, whose context is made only if there are any.
template <class MakeContext>
const std::vector<AovOutput>& aovs_of(const MaterialData& material, const MakeContext& make_context) {
  thread_local std::vector<AovOutput> outputs;
  outputs.clear();
  if (material.aovs.empty()) return outputs;
  ShadeResult* result = scratch();
  result->aovs = &outputs;
  run_noting_faults(material.aovs, make_context(), result);
  result->aovs = nullptr;
  return outputs;
}

}  // namespace

void shade_surface(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray,
                   float roughness_threshold, ShadeResult* result) {
  const MaterialData& material = material_of(scene, point.material);
  clear(result);
  result->fallback = material.uses_fallback;
  // A Lambert surface is not recorded on the tape. It does not depend on the direction on this side, and shading it
  // again for the other side is as fast as a replay.
  if (material.is_lambert) return shade_lambert(scene, material, point, wo, ray, roughness_threshold, result);
  const ShadeContext context = context_of(material, material.bumps, scene, point, wo, ray);
  run_noting_faults(material.surface, context, result);
  if (result->tape) result->tape->finish();
  complete(scene, material, point, context.geometric_normal, context.normal, wo, ray, roughness_threshold, result);
}

void shade_from_tape(const ShadedScene& scene, const geometry::SurfacePoint& point, const ClosureTape& tape,
                     const Vec3& known_wo, const Vec3& wo, const RayState& ray, float roughness_threshold,
                     ShadeResult* result) {
  const MaterialData& material = material_of(scene, point.material);
  const ShadeContext context = context_of(material, material.bumps, scene, point, wo, ray);
  const bool same_side = context.backfacing == (glm::dot(point.geometric_normal, known_wo) < 0.0f);
  clear(result);
  if (material.values_depend_on_ray || !same_side || !tape.replay(context, result)) {
    shade_surface(scene, point, wo, ray, roughness_threshold, result);
    return;
  }
  if (result->is_faulty) note_fault(context);
  result->fallback = material.uses_fallback;
  complete(scene, material, point, context.geometric_normal, context.normal, wo, ray, roughness_threshold, result);
}

void shade_without_closures(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                            const RayState& ray, float roughness_threshold, ShadeResult* result) {
  const MaterialData& material = material_of(scene, point.material);
  if (material.may_be_transparent || material.has_holdout) {
    shade_surface(scene, point, wo, ray, roughness_threshold, result);
    return;
  }
  clear(result);
  result->fallback = material.uses_fallback;
  result->emission = shade_emission(scene, point, wo, ray);
}

Rgb shade_emission(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray) {
  const MaterialData& material = material_of(scene, point.material);
  if (!material.emits) return Rgb(0.0f);
  if (material.emission_is_constant) return material.constant_emission;
  return emission_of(material, context_of(material, material.bumps_emission, scene, point, wo, ray));
}

Rgb shade_transparency(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                       const RayState& ray) {
  const MaterialData& material = material_of(scene, point.material);
  if (!material.may_be_transparent || ((ray.flags & kRayShadow) && !material.transparent_shadow)) return Rgb(0.0f);
  if (material.transparency_is_constant) return material.constant_transparency;
  ShadeResult* result = scratch();
  run_noting_faults(material.transparency, context_of(material, material.bumps_transparency, scene, point, wo, ray),
                    result);
  return result->transparency;
}

const std::vector<AovOutput>& shade_aovs(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                                         const RayState& ray) {
  const MaterialData& material = material_of(scene, point.material);
  return aovs_of(material, [&] { return context_of(material, material.bumps_aovs, scene, point, wo, ray); });
}

const std::vector<AovOutput>& shade_world_aovs(const ShadedScene& scene, const Vec3& direction, const RayState& ray) {
  static const std::vector<AovOutput> none;
  if (scene.world_material >= scene.materials.size()) return none;
  return aovs_of(*scene.materials[scene.world_material], [&] { return background_context(scene, direction, ray); });
}

Rgb shade_world(const ShadedScene& scene, const Vec3& direction, const RayState& ray) {
  if (scene.world_material >= scene.materials.size()) return Rgb(0.0f);
  const MaterialData& material = *scene.materials[scene.world_material];
  return emission_of(material, background_context(scene, direction, ray));
}

Rgb shade_light(const ShadedScene& scene, uint32_t material, const LightShadingPoint& point, const RayState& ray) {
  if (material >= scene.materials.size()) return Rgb(1.0f);
  ShadeContext context = light_context(scene, point, ray);
  context.material = material;
  return emission_of(*scene.materials[material], context);
}

}  // namespace gradus::shading
