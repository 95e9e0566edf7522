#include "path/light.h"

#include "light/light_table.h"

namespace gradus::path {

namespace {

// Returns whether a light with these visibility bits is visible to bounces of a light pass.
bool is_visible_to(uint32_t visibility, bsdf::LightPass pass, bool transmitted) {
  return (visibility & bounce_visibility(pass, transmitted)) != 0;
}

// Returns the transmittance of a segment for a diffuse bounce. `crossed` is the number of transparent surfaces that the
// path has passed.
Rgb diffuse_transmittance(const PathContext& context, const Ray& ray, uint32_t crossed) {
  PathRay bounce;
  bounce.visibility = GRADUS_VISIBLE_DIFFUSE;
  bounce.state.flags = shading::kRayDiffuse | shading::kRayReflection;
  auto transparent_depth = static_cast<uint16_t>(crossed);
  return segment_transmittance(context, ray, bounce, &transparent_depth);
}

// Returns whether the point is of a world that is left to BSDF sampling.
bool is_left_out(const PathContext& context, const light::LightPoint& point) {
  return point.kind == light::LightKind::World && context.scene.light_table->factors.world == 0.0;
}

}  // namespace

bool sample_light(const PathContext& context, const VertexSample& u, const Vertex& vertex, int depth,
                  LightSample* light) {
  if (!context.scene.features.has_lights || !vertex.shade.closures.has_smooth()) {
    return false;
  }
  const light::Receiver receiver = receiver_of(vertex);
  light::sample_light_point(context.scene, receiver, u.light_choice.x, u.light, &light->point, &light->view);
  if (light->point.kind == light::LightKind::None) {
    return false;
  }
  return light->view.pdf > 0.0f && !is_black(light->view.radiance) &&
         static_cast<uint32_t>(depth) <= light->view.max_bounces;
}

std::array<Rgb, 3> light_by_pass(const PathContext& context, const Vertex& vertex, bsdf::ScatterClass c,
                                 const LightSample& light, const shading::RayState& ray) {
  const light::LightEvaluation& view = light.view;
  const bool transmitted = glm::dot(vertex.light_normal(), view.direction) < 0.0f;
  std::array<Rgb, 3> passes = vertex.shade.closures.evaluate_by_pass(c, vertex.wo, view.direction, transmitted);
  for (int i = 0; i < 3; ++i) {
    const auto pass = static_cast<bsdf::LightPass>(i);
    if (is_black(passes[i])) continue;
    if (!is_visible_to(view.visibility, pass, transmitted)) {
      passes[i] = Rgb(0.0f);
    } else if (!view.by_kind) {
      passes[i] *= view.radiance;
    } else {
      shading::RayState next =
          next_ray_state(ray, pass == bsdf::LightPass::Diffuse, transmitted, false, context.diffuse_flags);
      next.length = view.distance;
      passes[i] *= light::evaluated_radiance(context.scene, light.point, view, next);
    }
  }
  return passes;
}

LitClass light_class(const PathContext& context, const Vertex& vertex, bsdf::ScatterClass c, const LightSample& light,
                     const shading::RayState& ray) {
  LitClass lit;
  const bsdf::Closures& closures = vertex.shade.closures;
  const float probability = closures.class_probability(c);
  if (!(probability > 0.0f) || !closures.has_smooth(c)) {
    return lit;
  }
  const light::LightEvaluation& view = light.view;
  const bool transmitted = glm::dot(vertex.light_normal(), view.direction) < 0.0f;
  const bsdf::BsdfEval eval = closures.evaluate_side(c, vertex.wo, view.direction, transmitted);
  const bool is_side_of_facet = transmitted == (glm::dot(vertex.facing_normal(), view.direction) < 0.0f);
  if (!is_side_of_facet && light::is_of_uniform_world(context.scene, light.point)) return lit;
  const bool found_by_rays = light.point.found_by_rays && is_side_of_facet;
  lit.value = eval.value * view.radiance;
  lit.pdf_bsdf = found_by_rays ? probability * eval.pdf : 0.0f;
  if (view.by_kind || (view.visibility & kAllBounces) != kAllBounces) {
    const std::array<Rgb, 3> passes = light_by_pass(context, vertex, c, light, ray);
    lit.value = passes[0] + passes[1] + passes[2];
  }
  // Rays do not find the world behind clear glass either.
  if (light.point.kind == light::LightKind::World && shows_background(ray) &&
      is_clear(context.glass_limit, vertex, c, view.direction, transmitted)) {
    lit.value = Rgb(0.0f);
  }
  return lit;
}

LightVisibility light_visibility(const PathContext& context, const geometry::SurfacePoint& from,
                                 const light::LightPoint& point, const light::LightEvaluation& view, uint32_t crossed) {
  if (!view.casts_shadow) {
    return {Rgb(1.0f)};
  }
  const Ray ray =
      light::ray_to_light(light::shadow_ray_origin(context.scene, from, point, view.direction), from, point, view);
  if (view.blockers != geometry::kAllSets) {
    return linked_visibility(context, ray, view.blockers);
  }
  if (light::is_of_uniform_world(context.scene, point)) {
    return {diffuse_transmittance(context, ray, crossed)};
  }
  return {shadow_transmittance(context, ray, crossed)};
}

Rgb shadow_transmittance(const PathContext& context, const Ray& ray, uint32_t crossed) {
  if (!context.scene.features.has_transparent_shadows) return Rgb(context.scene.occluded(ray) ? 0.0f : 1.0f);
  const uint32_t allowed = context.settings.transparent_max_bounces;
  return context.scene.transmittance(ray, crossed < allowed ? allowed - crossed : 0);
}

float light_pdf(const PathContext& context, const RaySource& source, const light::LightPoint& point) {
  if (!source.sampled_light() || point.kind == light::LightKind::None || is_left_out(context, point)) {
    return 0.0f;
  }
  return light::light_point_pdf(context.scene, point, receiver_of(*source.vertex));
}

light::LightEvaluation evaluate_crossing(const PathContext& context, const light::LightPoint& point,
                                         const light::Receiver& receiver, const shading::RayState& ray) {
  light::LightEvaluation view = light::evaluate_light(context.scene, point, receiver);
  if (view.by_kind) {
    shading::RayState state = ray;
    state.length = view.distance;
    view.radiance = light::evaluated_radiance(context.scene, point, view, state);
  }
  return view;
}

bool lights_source(const PathContext& context, const geometry::SurfacePoint& surface, const Vertex& source) {
  return (context.scene.instances[surface.hit.instance].links.receivers & source.point.light_set) != 0;
}

Rgb light_hit_radiance(const light::LightEvaluation& view, const PathRay& ray, int depth) {
  const bool visible = (view.visibility & ray.visibility) != 0;
  const bool within = depth == 0 || static_cast<uint32_t>(depth - 1) <= view.max_bounces;
  return visible && within ? view.radiance : Rgb(0.0f);
}

Rgb world_radiance(const PathContext& context, const PathRay& ray, int depth) {
  return meets_film_background(context, ray.state) ? Rgb(0.0f) : film_background_radiance(context, ray, depth);
}

Rgb film_background_radiance(const PathContext& context, const PathRay& ray, int depth) {
  const bool hidden = depth == 0 && context.settings.use_sky == 0;
  if (hidden || (context.scene.world.visibility & ray.visibility) == 0) {
    return Rgb(0.0f);
  }
  return shading::shade_world(context.scene, ray.ray.direction, ray.state);
}

}  // namespace gradus::path
