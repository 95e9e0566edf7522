#include "path/subsurface.h"

#include <algorithm>

#include "path/burley_disk.h"
#include "path/random_walk.h"
#include "shading/material.h"

namespace gradus::path {

namespace {

// The first step of a walk ignores the surface that it starts at, up to a distance that grows with the angle of the
// entry. Flatter entries are treated as having this cosine.
constexpr float kSmallestEntryCosine = 1e-3f;

// Walks below the surface. Sets hit and direction of the exit, and its weight.
bool walk_below(const PathContext& context, const Sampler& sampler, const VertexSample& u, int depth,
                const Vertex& entry, const bsdf::Lobe& lobe, WalkEnd* end, Rgb* weight) {
  Vec3 direction;
  const Vec3 out = entry.facing_normal();
  if (!bsdf::sample_entry(lobe, entry.wo, u.bsdf, &direction) || !(glm::dot(direction, out) < 0.0f)) return false;
  const bsdf::Medium medium = bsdf::medium_below(lobe, weight);
  const Vec3 normal = geometry::keep_above(entry.point.shading_normal, entry.point.geometric_normal);
  // The walk starts at the surface itself: its steps may be as short as an offset against rounding would be.
  const float nearest = entry.point.error / std::max(-glm::dot(direction, out), kSmallestEntryCosine);
  const WalkStart start{entry.point.position,
                        nearest,
                        direction,
                        glm::dot(normal, out) < 0.0f ? -normal : normal,
                        entry.point.hit.instance,
                        entry.point.hit.time};
  return walk(context, sampler, depth, medium, start, weight, end);
}

// Returns the normal of the surface at which light leaves. A bump there is that of its own subsurface lobes.
Vec3 exit_normal(const PathContext& context, const shading::RayState& ray, Vertex* exit) {
  const bool is_behind = glm::dot(exit->point.geometric_normal, exit->wo) < 0.0f;
  const Vec3 smooth = is_behind ? -exit->point.shading_normal : exit->point.shading_normal;
  if (!context.scene.materials[exit->point.material]->bumps_subsurface) return smooth;
  shading::shade_surface(context.scene, exit->point, exit->wo, ray, context.settings.roughness_threshold, &exit->shade);
  Vec3 sum(0.0f);
  for (int i = 0; i < exit->shade.closures.count(); ++i) {
    const bsdf::Lobe& lobe = exit->shade.closures.lobe(i);
    if (lobe.type == bsdf::LobeType::Subsurface) sum += lobe.normal * mean_component(lobe.weight);
  }
  return sum == Vec3(0.0f) ? smooth : glm::normalize(sum);
}

// Returns the GradusShadingNormals of light that leaves, whose normal is not tilted towards the geometric normal.
uint32_t exit_shading_normals(const PathContext& context, const Vertex& exit) {
  const uint32_t version = context.scene.materials[exit.point.material]->shading_normals;
  return version == GRADUS_SHADING_NORMALS_BEFORE_3_6 ? uint32_t{GRADUS_SHADING_NORMALS_SINCE_3_6} : version;
}

// Sets the closures of the exit: a diffuse lobe.
void shade_exit(const PathContext& context, const shading::RayState& ray, const bsdf::Lobe& entry, Vertex* exit) {
  const Vec3 normal = exit_normal(context, ray, exit);
  const bool is_behind = glm::dot(exit->point.geometric_normal, exit->wo) < 0.0f;
  shading::ShadeResult& shade = exit->shade;
  shade.closures.clear();
  shade.emission = shade.transparency = shade.holdout = Rgb(0.0f);
  bsdf::add_exit(entry, normal, &shade.closures);
  shade.closures.set_terminator_frequency(exit->point.terminator_frequency);
  shade.closures.set_shading_normals(exit_shading_normals(context, *exit));
  shade.closures.finish(exit->wo, exit->facing_normal(), context.settings.roughness_threshold,
                        is_behind ? -exit->point.shading_normal : exit->point.shading_normal);
  shade.complete = true;
  shade.ignores_wo = true;
}

}  // namespace

bool scatter_below(const PathContext& context, const Sampler& sampler, int depth, const shading::RayState& ray,
                   const Vertex& entry, SubsurfaceEvent* event, Vertex* exit) {
  const VertexSample u = sampler.vertex(depth);
  const bsdf::Closures& closures = entry.shade.closures;
  float probability = 0.0f;
  event->lobe = closures.choose_subsurface(u.lobe.y, &probability);
  event->pdf = closures.class_probability(bsdf::ScatterClass::Subsurface) * probability;
  const bsdf::Lobe& lobe = closures.lobe(event->lobe);
  WalkEnd end;
  Rgb weight = lobe.weight;
  const bool leaves = lobe.subsurface == bsdf::SubsurfaceMethod::Disk
                          ? probe_disk(context, sampler, u, depth, entry, lobe, &end, &weight)
                          : walk_below(context, sampler, u, depth, entry, lobe, &end, &weight);
  event->factor = weight / event->pdf;
  if (!leaves || !(event->pdf > 0.0f) || is_black(weight)) return false;
  context.scene.place(end.hit, &exit->point);
  exit->wo = end.direction;
  shade_exit(context, ray, lobe, exit);
  return true;
}

}  // namespace gradus::path
