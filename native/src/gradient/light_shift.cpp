#include "gradient/light_shift.h"

#include "geometry/shadow_terminator.h"
#include "gradient/emission_shift.h"
#include "gradient/offset_rays.h"
#include "gradient/random_replay.h"
#include "gradient/reconnection.h"
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

// Traces the shadow rays of the wanted offsets together, through a scene without transparent shadows.
void trace_shadow_packet(const BasePath& base, const path::LightSample& sample, const OffsetPaths& offsets,
                         const bool* wanted, bool* blocked) {
  const light::LightEvaluation& a = offsets[0].light.view;
  const light::LightEvaluation& b = offsets[1].light.view;
  const light::LightEvaluation& c = offsets[2].light.view;
  const light::LightEvaluation& d = offsets[3].light.view;
  const geometry::Lanes3 direction = geometry::lanes(a.direction, b.direction, c.direction, d.direction);
  const geometry::Lanes distance{a.distance, b.distance, c.distance, d.distance};
  const geometry::Points4 points = offset_points(offsets, base.camera_sample.time);
  geometry::Lanes3 start = geometry::offset_origins(points, direction);
  for (int k = 0; k < film::kOffsets; ++k) {
    const geometry::SurfacePoint& point = offsets[k].vertex->point;
    const Vec3& to_light = offsets[k].light.view.direction;
    if (wanted[k] && !geometry::leaves_facet(point, to_light))
      geometry::set_lane(k, light::shadow_ray_origin(base.context.scene, point, sample.point, to_light), &start);
  }
  base.context.scene.occluded4(light::rays_to_light(start, points, direction, distance, sample.point), wanted, blocked);
}

// Returns whether a light sample that is visible from the base's vertex is also visible to a path that has already
// passed `transparent_depth` transparent surfaces, whose number is limited.
bool is_lit(const BasePath& base, const path::Vertex& vertex, const path::LightSample& sample,
            uint32_t transparent_depth) {
  if (!base.context.scene.features.has_transparent_shadows ||
      transparent_depth <= base.state.ray.state.transparent_depth) {
    return true;
  }
  return !is_black(
      path::light_visibility(base.context, vertex.point, sample.point, sample.view, transparent_depth).transmittance);
}

}  // namespace

void light_coupled(const BasePath& base, const path::LightSample& sample, bsdf::ScatterClass scatter_class,
                   OffsetPaths* offsets, film::Counters* counters) {
  const path::PathContext& context = base.context;
  bool wanted[film::kOffsets];
  bool blocked[film::kOffsets] = {};
  bool any = false;
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = (*offsets)[k];
    OffsetLightSample& light = o.light;
    wanted[k] = false;
    if (o.stage != OffsetStage::Coupled) {
      continue;
    }
    if (!light.is_known) {
      light = OffsetLightSample{};
      light.is_known = true;
      light.view = view_from(context, sample, *o.vertex);
    }
    light.lit = path::light_class(context, *o.vertex, scatter_class, path::LightSample{sample.point, light.view},
                                  base.state.ray.state);
    wanted[k] = !light.is_traced && !is_black(light.lit.value);
    if (wanted[k]) {
      light.is_traced = true;
      ++counters->rays_shift_shadow;
      any = true;
    }
  }
  const bool traces_packet = !context.scene.features.has_transparent_shadows && sample.view.casts_shadow &&
                             sample.view.blockers == geometry::kAllSets;
  if (any && traces_packet) {
    trace_shadow_packet(base, sample, *offsets, wanted, blocked);
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    if (wanted[k]) {
      OffsetPath& o = (*offsets)[k];
      o.light.visibility = traces_packet ? path::LightVisibility{Rgb(blocked[k] ? 0.0f : 1.0f)}
                                         : path::light_visibility(context, o.vertex->point, sample.point, o.light.view,
                                                                  o.state.ray.state.transparent_depth);
    }
  }
}

ShiftedContribution copy_light_sample(const BasePath& base, const path::Vertex& x, const path::LightSample& sample,
                                      bsdf::ScatterClass scatter_class, const path::Contribution& c,
                                      const OffsetPath& offset) {
  const light::LightEvaluation& view = offset.light.view;
  const path::LitClass& lit = offset.light.lit;
  const bool is_joint = weights_jointly(base, view, offset) && reconnects(scatter_class) &&
                        sample.point.found_by_rays &&
                        both_leave_facets(x, sample.view.direction, offset, view.direction);
  const float pdf = is_joint ? view.pdf + lit.pdf_bsdf : view.pdf;
  const float base_pdf = is_joint ? c.pdf_light + c.pdf_bsdf : c.pdf_light;
  const path::LightVisibility& visibility = offset.light.visibility;
  if (is_black(lit.value) || is_black(visibility.transmittance) || !(pdf > 0.0f)) {
    return unpaired(is_black(lit.value)                  ? ShiftFailure::Class
                    : is_black(visibility.transmittance) ? ShiftFailure::Occluded
                                                         : ShiftFailure::Density);
  }
  Rgb value = offset.state.throughput * lit.value * visibility.transmittance / (view.pdf + lit.pdf_bsdf);
  if (visibility.is_hidden) value *= path::hidden_share(view.pdf, lit.pdf_bsdf);
  return paired(value, offset.ratio * copy_jacobian(sample.point, sample.view, view) * pdf / base_pdf);
}

ShiftedContribution connect_to_lit_vertex(const BasePath& base, const path::Vertex& z, const path::LightSample& sample,
                                          bsdf::ScatterClass scatter_class, const path::Contribution& c,
                                          OffsetPath* offset) {
  const OffsetConnection& connection = offset->connection;
  if (!connection.is_open || !connection.may_scatter || !sees_same_side(*offset, z) ||
      !is_lit(base, z, sample, connection.transparent_depth)) {
    return unpaired();
  }
  const float ratio = connection.ratio * connection.kind_ratio;
  shade_shared_vertex(base, z, offset);
  if (connection.scatters_alike && ratio > 0.0f) {
    return paired(connection.throughput * c.tail, ratio);
  }
  const path::LitClass lit = connection.scatters_alike ? path::LitClass{}
                                                       : path::light_class(base.context, *offset->shared_vertex,
                                                                           scatter_class, sample, base.state.ray.state);
  // A texture that depends on the ray may make the vertex non-specular for the offset alone. The inverse shift would
  // then be a replay, so this pair is not allowed.
  if (is_black(lit.value) || !(ratio > 0.0f) ||
      replays(base.position, offset->vertex->point.position, *offset->shared_vertex)) {
    return unpaired(ShiftFailure::Class);
  }
  const bool is_joint = weights_jointly(base, sample.view, *offset) && reconnects(scatter_class) &&
                        sample.point.found_by_rays && geometry::leaves_facet(z.point, sample.view.direction);
  const float density_ratio = is_joint ? (c.pdf_light + lit.pdf_bsdf) / (c.pdf_light + c.pdf_bsdf) : 1.0f;
  Rgb value = connection.throughput * lit.value * c.light / (c.pdf_light + lit.pdf_bsdf);
  if (c.is_hidden) value *= path::hidden_share(c.pdf_light, lit.pdf_bsdf);
  return paired(value, ratio * density_ratio);
}

ShiftedContribution share_light_sample(const BasePath& base, const path::Vertex& z, const path::LightSample& sample,
                                       const path::Contribution& c, const OffsetPath& offset) {
  if (!is_lit(base, z, sample, offset.state.ray.state.transparent_depth)) {
    return unpaired(ShiftFailure::Occluded);
  }
  return paired(offset.state.throughput * c.tail, offset.ratio);
}

}  // namespace gradus::gradient
