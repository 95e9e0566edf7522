// Light samples of the base path, shifted to its offset paths. The comment of offset_emission.cpp explains the weights.
#include "geometry/shadow_terminator.h"
#include "gradient/offset_paths.h"
#include "light/light_rays4.h"

namespace gradus::gradient {

namespace {

// Evaluates the light sample from `vertex`. A sample of the world has the same direction and radiance everywhere, so
// only its density is evaluated again.
light::LightEvaluation view_from(const path::PathContext& context, const path::LightSample& sample,
                                 const path::Vertex& vertex) {
  if (sample.point.kind != light::LightKind::World) {
    return light::evaluate_light(context.scene, sample.point, path::receiver_of(vertex));
  }
  light::LightEvaluation view = sample.view;
  view.pdf = light::light_point_pdf(context.scene, sample.point, path::receiver_of(vertex));
  return view;
}

}  // namespace

// Evaluates the copied light sample at the vertices of all offsets at stage Traced. Shadow rays are traced together,
// and only for offsets whose vertex scatters the light.
void OffsetPaths::light_all(const path::LightSample& sample, bsdf::ScatterClass scatter_class) {
  bool wanted[film::kOffsets];
  bool blocked[film::kOffsets] = {};
  bool any = false;
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    OffsetLightSample& light = o.light;
    wanted[k] = false;
    if (o.stage != OffsetStage::Traced) {
      continue;
    }
    if (!light.known) {
      light = OffsetLightSample{};
      light.known = true;
      light.view = view_from(context_, sample, *o.here);
    }
    light.lit = path::light_class(context_, *o.here, scatter_class, path::LightSample{sample.point, light.view},
                                  base_state_.ray.state);
    wanted[k] = !light.traced && !is_black(light.lit.value);
    if (wanted[k]) {
      light.traced = true;
      ++counters_.rays_shift_shadow;
      any = true;
    }
  }
  const bool packet = !context_.scene.features.has_transparent_shadows && sample.view.casts_shadow;
  if (any && packet) {
    const light::LightEvaluation& a = offsets_[0].light.view;
    const light::LightEvaluation& b = offsets_[1].light.view;
    const light::LightEvaluation& c = offsets_[2].light.view;
    const light::LightEvaluation& d = offsets_[3].light.view;
    const geometry::Lanes3 direction = geometry::lanes(a.direction, b.direction, c.direction, d.direction);
    const geometry::Lanes distance{a.distance, b.distance, c.distance, d.distance};
    const geometry::Points4 points = offset_points();
    geometry::Lanes3 start = geometry::offset_origins(points, direction);
    for (int k = 0; k < film::kOffsets; ++k) {
      const OffsetPath& o = offsets_[k];
      if (wanted[k] && !geometry::leaves_facet(o.here->point, o.light.view.direction))
        geometry::set_lane(k, geometry::shadow_origin(context_.scene, o.here->point, o.light.view.direction), &start);
    }
    context_.scene.occluded4(light::rays_to_light(start, points, direction, distance, sample.point), wanted, blocked);
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    if (wanted[k]) {
      OffsetPath& o = offsets_[k];
      o.light.transmittance = packet ? Rgb(blocked[k] ? 0.0f : 1.0f)
                                     : path::light_transmittance(context_, o.here->point, sample.point, o.light.view,
                                                                 o.state.ray.state.transparent_depth);
    }
  }
}

void OffsetPaths::light_decoupled_vertex(int k, const path::Vertex& vertex, const path::LightSample& sample,
                                         bsdf::ScatterClass scatter_class, const path::Contribution& c) {
  OffsetPath& o = offsets_[k];
  const light::LightEvaluation& view = o.light.view;
  const path::LitClass& lit = o.light.lit;
  const bool all = joint(view, o) && reconnects(scatter_class) && sample.point.found_by_rays &&
                   both_leave_facets(vertex, sample.view.direction, o, view.direction);
  const float pdf = all ? view.pdf + lit.pdf_bsdf : view.pdf;
  const float base_pdf = all ? c.pdf_light + c.pdf_bsdf : c.pdf_light;
  if (is_black(lit.value) || is_black(o.light.transmittance) || !(pdf > 0.0f)) {
    ++(is_black(lit.value)               ? counters_.fail_class
       : is_black(o.light.transmittance) ? counters_.fail_occluded
                                         : counters_.fail_density);
    add_unpaired(k, c);
    return;
  }
  const Rgb value = o.state.throughput * lit.value * o.light.transmittance / (view.pdf + lit.pdf_bsdf);
  pair(k, c, value, o.ratio * copy_jacobian(sample.point, sample.view, view) * pdf / base_pdf);
}

// Returns whether a light sample that is visible from the base's vertex is also visible to a path that has already
// passed `transparent_depth` transparent surfaces, whose number is limited.
bool OffsetPaths::is_lit(const path::Vertex& vertex, const path::LightSample& sample,
                         uint32_t transparent_depth) const {
  if (!context_.scene.features.has_transparent_shadows ||
      transparent_depth <= base_state_.ray.state.transparent_depth) {
    return true;
  }
  return !is_black(path::light_transmittance(context_, vertex.point, sample.point, sample.view, transparent_depth));
}

// Pairs the light sample at the shared vertex with its contribution to offset k. The light, its visibility and its
// density p_n are those of the base; only the outgoing direction differs.
void OffsetPaths::light_reconnected(int k, const path::Vertex& vertex, const path::LightSample& sample,
                                    bsdf::ScatterClass scatter_class, const path::Contribution& c) {
  OffsetPath& o = offsets_[k];
  if (!o.connection.open || !(glm::dot(vertex.facing_normal(), o.reconnected->wo) > 0.0f) ||
      !is_lit(vertex, sample, o.connection.transparent_depth)) {
    add_unpaired(k, c);
    return;
  }
  const float connection_ratio = o.connection.ratio * o.connection.kind_ratio;
  shade_reconnected(&o, vertex);
  if (o.connection.looks_same && connection_ratio > 0.0f) {
    pair(k, c, o.connection.throughput * c.tail, connection_ratio);
    return;
  }
  const path::LitClass lit = o.connection.looks_same ? path::LitClass{}
                                                     : path::light_class(context_, *o.reconnected, scatter_class,
                                                                         sample, base_state_.ray.state);
  // A texture that depends on the ray may make the vertex rough for the offset alone. The inverse shift would then be a
  // replay, so this pair is not allowed.
  if (is_black(lit.value) || !(connection_ratio > 0.0f) || replays(o.here->point.position, *o.reconnected)) {
    ++counters_.fail_class;
    add_unpaired(k, c);
    return;
  }
  const bool all = joint(sample.view, o) && reconnects(scatter_class) && sample.point.found_by_rays &&
                   geometry::leaves_facet(vertex.point, sample.view.direction);
  const float ratio = all ? (c.pdf_light + lit.pdf_bsdf) / (c.pdf_light + c.pdf_bsdf) : 1.0f;
  pair(k, c, o.connection.throughput * lit.value * c.light / (c.pdf_light + lit.pdf_bsdf), connection_ratio * ratio);
}

void OffsetPaths::light(const path::Vertex& vertex, const path::LightSample& sample, bsdf::ScatterClass scatter_class,
                        const path::Contribution& c) {
  collect(c, Rgb(1.0f));
  if (open_ == 0) {
    return;
  }
  reconnect_all(vertex);
  light_all(sample, scatter_class);
  for (int k = 0; k < film::kOffsets; ++k) {
    const OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Pending) {
      light_reconnected(k, vertex, sample, scatter_class, c);
    } else if (o.stage == OffsetStage::Traced) {
      light_decoupled_vertex(k, vertex, sample, scatter_class, c);
    } else if (o.stage == OffsetStage::Deeper) {
      if (is_lit(vertex, sample, o.state.ray.state.transparent_depth)) {
        pair(k, c, o.state.throughput * c.tail, o.ratio);
      } else {
        ++counters_.fail_occluded;
        add_unpaired(k, c);
      }
    }
  }
}

}  // namespace gradus::gradient
