#include "path/contribution.h"

namespace gradus::path {

namespace {

// Returns the contribution of an emitter that the path's ray has found. As in Cycles, it is indirect after at least two
// scattering events.
Contribution found_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                const Rgb& throughput, const Rgb& radiance, float pdf_light, bool is_hidden = false) {
  Contribution c;
  c.pdf_light = pdf_light;
  c.pdf_bsdf = source.sampled_light() ? source.event->pdf : 0.0f;
  c.indirect = state.depth > 1;
  c.component = context.components.component(state.lpe_state);
  c.light = radiance;
  c.is_hidden = is_hidden;
  c.tail = radiance * bsdf_weight(c.pdf_light, c.pdf_bsdf);
  if (is_hidden) c.tail *= hidden_share(c.pdf_light, c.pdf_bsdf);
  c.clamped = clamp_contribution(context, throughput * c.tail, c.indirect);
  return c;
}

// Returns the contribution of the world, whose radiance towards the path's ray is given.
Contribution distant_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                  const Rgb& radiance) {
  if (is_black(radiance)) {
    return {};
  }
  const light::LightPoint point = source.sampled_light()
                                      ? light::light_point_of_world(context.scene, state.ray.ray.direction)
                                      : light::LightPoint{};
  return found_contribution(context, source, state, state.throughput, radiance, light_pdf(context, source, point));
}

// Returns whether a ray shows the emission of the surface at its end. The ray of a bounce does not where the surface
// does not light the source, and where the segment has found it already as a light crossing, because it has blockers.
bool shows_emission(const PathContext& context, const RaySource& source, const geometry::SurfacePoint& surface) {
  if (!context.scene.light_table->has_links || source.vertex == nullptr) {
    return true;
  }
  return lights_source(context, surface, *source.vertex) && !is_crossed_emitter(context, surface);
}

}  // namespace

void apply_segment(const Segment& segment, PathState* state) { state->throughput *= segment.weight; }

Contribution light_hit_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                    const LightCrossing& crossing) {
  const RaySource seen_from = crossing.is_behind_portal ? RaySource{} : source;
  const light::Receiver eye{crossing.eye, Vec3(0.0f), true};
  const light::Receiver receiver = seen_from.vertex != nullptr ? receiver_of(*seen_from.vertex) : eye;
  const light::LightEvaluation view = evaluate_crossing(context, crossing.point, receiver, state.ray.state);
  const Rgb radiance = light_hit_radiance(view, state.ray, state.depth);
  if (is_black(radiance)) {
    return {};
  }
  return found_contribution(context, seen_from, state, state.throughput * crossing.weight, radiance,
                            seen_from.sampled_light() ? view.pdf : 0.0f, crossing.is_hidden);
}

Contribution world_contribution(const PathContext& context, const RaySource& source, const PathState& state) {
  return distant_contribution(context, source, state, world_radiance(context, state.ray, state.depth));
}

Contribution film_background_contribution(const PathContext& context, const RaySource& source, const PathState& state) {
  return distant_contribution(context, source, state, film_background_radiance(context, state.ray, state.depth));
}

Contribution emission_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                   const Vertex& vertex) {
  if (is_black(vertex.shade.emission) || !shows_emission(context, source, vertex.point)) {
    return {};
  }
  const light::LightPoint point =
      source.sampled_light() ? light::light_point_of_surface(context.scene, vertex.point) : light::LightPoint{};
  return found_contribution(context, source, state, state.throughput, vertex.shade.emission,
                            light_pdf(context, source, point));
}

bool light_classes(const PathContext& context, const Vertex& vertex, const LightSample& light,
                   const shading::RayState& ray, LitClass lit[bsdf::kPathEvents]) {
  bool any = false;
  for (int k = 0; k < bsdf::kPathEvents; ++k) {
    const auto c = static_cast<bsdf::ScatterClass>(k);
    lit[k] = vertex.shade.closures.has_smooth(c) ? light_class(context, vertex, c, light, ray) : LitClass{};
    any |= !is_black(lit[k].value);
  }
  return any;
}

Contribution light_contribution(const PathContext& context, const PathState& state, const LightSample& light,
                                bsdf::ScatterClass scatter_class, const LitClass& lit,
                                const LightVisibility& visibility) {
  Contribution c;
  if (is_black(lit.value)) {
    return c;
  }
  c.pdf_light = light.view.pdf;
  c.pdf_bsdf = lit.pdf_bsdf;
  c.indirect = state.depth > 0;
  c.component = context.components.component(context.components.next(state.lpe_state, scatter_class));
  c.light = visibility.transmittance;
  c.is_hidden = visibility.is_hidden;
  c.tail = lit.value * c.light / (c.pdf_light + c.pdf_bsdf);
  if (c.is_hidden) c.tail *= hidden_share(c.pdf_light, c.pdf_bsdf);
  c.clamped = clamp_contribution(context, state.throughput * c.tail, c.indirect);
  return c;
}

bool cuts_hole(const PathContext& context, const Vertex& vertex) {
  constexpr uint32_t kHoles = GRADUS_HOLDOUT | GRADUS_SHADOW_CATCHER;
  return (context.scene.instances[vertex.point.hit.instance].visibility & kHoles) != 0;
}

float holdout_alpha(const Rgb& throughput, const Rgb& holdout) {
  return is_black(holdout) ? 0.0f : mean_component(throughput * holdout);
}

}  // namespace gradus::path
