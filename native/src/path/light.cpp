#include "path/light.h"

namespace gradus {

namespace {

constexpr uint32_t kAllBounces = GRADUS_VISIBLE_DIFFUSE | GRADUS_VISIBLE_GLOSSY | GRADUS_VISIBLE_TRANSMISSION;

// Which light passes an emitter with these visibility bits may be scattered by, for a direction on this side.
bool sees(uint32_t visibility, LightPass pass, bool transmitted) { return (visibility & bounce_visibility(pass, transmitted)) != 0; }

}  // namespace

bool sample_light(const PathContext& context, const Sampler& sampler, const Vertex& vertex, int depth, LightSample* light) {
  if (!context.scene.features.has_emitters || vertex.shade.closures.empty()) {
    return false;
  }
  const uint32_t block = dimension::kFirstVertex + static_cast<uint32_t>(depth) * dimension::kPerVertex;
  const Receiver receiver = receiver_of(vertex);
  light->point = sample_emitter(context.scene, receiver, sampler.get1(block + dimension::kLightChoice),
                                sampler.get2(block + dimension::kLight), &light->view);
  if (light->point.kind == EmitterKind::None) {
    return false;
  }
  return light->view.pdf > 0.0f && !is_black(light->view.radiance) && static_cast<uint32_t>(depth) <= light->view.max_bounces;
}

LitClass light_class(const Vertex& vertex, ScatterClass c, const EmitterView& view, bool dirac_emitter) {
  LitClass lit;
  const Closures& closures = vertex.shade.closures;
  const float probability = closures.class_probability(c);
  if (!(probability > 0.0f) || !closures.has_smooth(c)) {
    return lit;
  }
  const BsdfEval eval = closures.evaluate(c, vertex.wo, view.direction);
  lit.value = eval.value;
  lit.pdf_bsdf = dirac_emitter ? 0.0f : probability * eval.pdf;
  if ((view.visibility & kAllBounces) != kAllBounces) {
    const bool transmitted = glm::dot(vertex.facing_normal(), view.direction) < 0.0f;
    const std::array<Rgb, 3> parts = closures.evaluate_by_pass(c, vertex.wo, view.direction);
    lit.value = Rgb(0.0f);
    for (int pass = 0; pass < 3; ++pass) {
      lit.value += sees(view.visibility, static_cast<LightPass>(pass), transmitted) ? parts[pass] : Rgb(0.0f);
    }
  }
  return lit;
}

Rgb light_transmittance(const PathContext& context, const SurfacePoint& from, const EmitterPoint& point, const EmitterView& view,
                        uint32_t crossed) {
  if (!view.casts_shadow) {
    return Rgb(1.0f);
  }
  const Ray ray = shadow_ray(from, point, view);
  if (!context.scene.features.has_transparent_shadows) {
    return Rgb(context.scene.occluded(ray) ? 0.0f : 1.0f);
  }
  const uint32_t allowed = context.settings.transparent_max_bounces;
  return context.scene.transmittance(ray, crossed < allowed ? allowed - crossed : 0);
}

float light_pdf(const PathContext& context, const RaySource& source, const EmitterPoint& point) {
  if (!source.sampled_light() || point.kind == EmitterKind::None) {
    return 0.0f;
  }
  return emitter_pdf(context.scene, point, receiver_of(*source.vertex));
}

Rgb lamp_radiance(const PathContext&, const EmitterView& view, const PathRay& ray, int depth) {
  const bool visible = (view.visibility & ray.visibility) != 0;
  const bool within = depth == 0 || static_cast<uint32_t>(depth - 1) <= view.max_bounces;
  return visible && within ? view.radiance : Rgb(0.0f);
}

Rgb world_radiance(const PathContext& context, const PathRay& ray, int depth) {
  const bool hidden = depth == 0 && (context.settings.film_transparent != 0 || context.settings.use_sky == 0);
  if (hidden || (context.scene.world.visibility & ray.visibility) == 0) {
    return Rgb(0.0f);
  }
  return shade_world(context.scene, ray.ray.direction, ray.state);
}

}  // namespace gradus
