#include "gradient/emission_shift.h"

#include <utility>

#include "geometry/shadow_terminator.h"
#include "gradient/reconnection.h"

namespace gradus::gradient {

namespace {

// Returns the factor that turns a ratio of BSDF densities into the ratio of the summed densities of both techniques.
float joint_factor(const path::Contribution& base, float pdf_light, float pdf_bsdf) {
  return (1.0f + pdf_light / pdf_bsdf) / (1.0f + base.pdf_light / base.pdf_bsdf);
}

Radiance evaluate_own_emission(const BasePath& base, OffsetPath* offset) {
  const path::PathContext& context = base.context;
  const OffsetPath& o = *offset;
  Radiance emission(0.0f);
  for (const path::LightCrossing& crossing : o.segment->light_crossings) {
    emission += Radiance(path::light_hit_contribution(context, o.source(), o.state, crossing).clamped, 0.0f);
  }
  offset->state.throughput *= o.segment->weight;
  const float opaque = mean_component(o.state.throughput);
  const path::RaySource seen_from = o.segment->passes_portal ? path::RaySource{} : o.source();
  if (o.segment->end == path::SegmentEnd::Escaped) {
    const bool shows_through = o.state.shows_background() && context.settings.film_transparent != 0;
    emission += Radiance(path::world_contribution(context, seen_from, o.state).clamped, shows_through ? -opaque : 0.0f);
  } else if (o.segment->end == path::SegmentEnd::Surface) {
    const shading::ShadeResult& shade = o.vertex->shade;
    if (o.state.shows_background() && path::cuts_hole(context, *o.vertex)) {
      return emission - Radiance(0.0f, 0.0f, 0.0f, opaque);
    }
    const float held_out = o.state.shows_background() ? path::holdout_alpha(o.state.throughput, shade.holdout) : 0.0f;
    if (is_black(shade.emission)) {
      return emission - Radiance(0.0f, 0.0f, 0.0f, held_out);
    }
    emission += Radiance(path::emission_contribution(context, seen_from, o.state, *o.vertex).clamped, -held_out);
  }
  return emission;
}

}  // namespace

float copy_jacobian(const light::LightPoint& point, const light::LightEvaluation& base,
                    const light::LightEvaluation& offset) {
  const bool is_one = point.dirac || point.at_infinity();
  return is_one ? 1.0f : area_jacobian(base.cosine, base.distance, offset.cosine, offset.distance);
}

bool weights_jointly(const BasePath& base, const light::LightEvaluation& view, const OffsetPath& offset) {
  return base.has_same_integrand && !offset.copies_class_choice && view.casts_shadow &&
         (view.visibility & path::kAllBounces) == path::kAllBounces;
}

bool both_leave_facets(const path::Vertex& base, const Vec3& base_direction, const OffsetPath& offset,
                       const Vec3& direction) {
  return geometry::leaves_facet(base.point, base_direction) && geometry::leaves_facet(offset.vertex->point, direction);
}

// The emission on a camera ray that several base paths use as their offset is evaluated once.
Radiance own_emission(const BasePath& base, OffsetPath* offset) {
  path::CameraVertex* shared = offset->camera_vertex;
  if (shared == nullptr) {
    return evaluate_own_emission(base, offset);
  }
  if (!std::exchange(shared->has_emission, true)) {
    shared->emission = evaluate_own_emission(base, offset);
  }
  return shared->emission;
}

ShiftedContribution copy_light_point(const BasePath& base, const path::RaySource& source, const path::Contribution& c,
                                     const light::LightPoint& point, const light::LightEvaluation& base_view,
                                     const light::LightEvaluation& view, float probability, const OffsetPath& offset,
                                     film::Counters* counters) {
  const ShiftedEvent event =
      event_towards(base.event, *offset.vertex, view.direction, copy_jacobian(point, base_view, view));
  if (event.failure != ShiftFailure::None || is_black(view.radiance)) {
    return unpaired(event.failure);
  }
  ++counters->rays_shift_shadow;
  uint16_t transparent_depth = offset.state.ray.state.transparent_depth;
  const geometry::SurfacePoint& from = offset.vertex->point;
  const Ray ray = light::ray_to_light(geometry::offset_origin(from, view.direction), from, point, view);
  const path::LightVisibility visibility =
      view.blockers != geometry::kAllSets
          ? path::linked_visibility(base.context, ray, view.blockers)
          : path::LightVisibility{path::segment_transmittance(base.context, ray, base.state.ray, &transparent_depth)};
  if (is_black(visibility.transmittance)) {
    return unpaired(ShiftFailure::Occluded);
  }
  Rgb value = offset.state.throughput * event.factor * view.radiance * visibility.transmittance *
              (path::bsdf_weight(view.pdf, event.pdf) / probability);
  if (visibility.is_hidden) value *= path::hidden_share(view.pdf, event.pdf);
  const bool is_joint = weights_jointly(base, base_view, offset) &&
                        both_leave_facets(*source.vertex, base_view.direction, offset, view.direction);
  return paired(value, offset.ratio * event.ratio * (is_joint ? joint_factor(c, view.pdf, event.pdf) : 1.0f));
}

ShiftedContribution connect_to_emission(const BasePath& base, const path::RaySource& source,
                                        const path::Contribution& c, const light::LightPoint& point,
                                        const path::Vertex& z, const OffsetPath& offset) {
  const OffsetConnection& connection = offset.connection;
  const bool is_lit = connection.is_open && (!base.context.scene.light_table->has_links ||
                                             path::lights_source(base.context, z.point, *offset.vertex));
  const Rgb emission = is_lit ? shared_emission(base, offset, z) : Rgb(0.0f);
  if (is_black(emission)) {
    return unpaired();  // connect_pending() has counted the cause
  }
  const float pdf_light = path::light_pdf(base.context, path::RaySource{offset.vertex, source.event}, point);
  const Rgb value = connection.throughput * emission * path::bsdf_weight(pdf_light, connection.pdf);
  const bool is_joint = base.has_same_integrand && !offset.copies_class_choice &&
                        both_leave_facets(*source.vertex, base.state.ray.ray.direction, offset,
                                          glm::normalize(z.point.position - offset.vertex->point.position));
  return paired(value, connection.ratio * (is_joint ? joint_factor(c, pdf_light, connection.pdf) : 1.0f));
}

// Directly behind the first shared vertex, the offset scattered with a density of its own. So its weight against light
// sampling, whose density both paths share, differs from the base's.
ShiftedContribution share_emission(const BasePath& base, const path::RaySource& source, const path::Contribution& c,
                                   const Rgb& weight, bool is_joint, const OffsetPath& offset) {
  if (offset.stage == OffsetStage::Deeper || !(c.pdf_light > 0.0f)) {
    return paired(offset.state.throughput * weight * c.tail, offset.ratio);
  }
  Rgb value = offset.state.throughput * weight * c.light * path::bsdf_weight(c.pdf_light, offset.shared_pdf);
  if (c.is_hidden) value *= path::hidden_share(c.pdf_light, offset.shared_pdf);
  // Light samples of specular classes are shifted without sharing a direction, so they cannot be weighted jointly.
  const bool all = is_joint && reconnects(base.event.scatter_class) &&
                   geometry::leaves_facet(source.vertex->point, base.state.ray.ray.direction);
  return paired(value, offset.ratio * (all ? joint_factor(c, c.pdf_light, offset.shared_pdf) : 1.0f));
}

}  // namespace gradus::gradient
