#include "gradient/reconnection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/rays4.h"
#include "gradient/offset_rays.h"

namespace gradus::gradient {

namespace {

// Returns the reconnection of an offset to `z` as an event at the offset's vertex, apart from visibility.
ShiftedEvent reconnection_event(const BasePath& base, const OffsetPath& offset, const path::Vertex& z) {
  const Reconnection connection =
      reconnect(base.position, offset.vertex->point.position, z.point.position, z.point.geometric_normal);
  if (connection.failure != ShiftFailure::None) {
    return failed_event(connection.failure);
  }
  return event_towards(base.event, *offset.vertex, connection.direction, connection.jacobian);
}

// Stores the connection of an offset to the shared vertex. The base's decisions at transparent surfaces on its segment
// apply to both paths, so the transparent surfaces of the offset's own segment are weighted by their expectation.
void open_connection(const BasePath& base, const ShiftedEvent& event, const Rgb& transmittance, OffsetPath* offset) {
  OffsetConnection& connection = offset->connection;
  connection.is_open = true;
  connection.may_scatter = connection.transparent_depth < base.context.max_transparent;
  connection.throughput = offset->state.throughput * event.factor * transmittance / base.segment->probability;
  connection.ratio = offset->ratio * event.ratio;
  connection.kind_ratio = event.kind_ratio;
  connection.pdf = event.pdf;
  const path::Vertex& y = *offset->vertex;
  connection.blur =
      std::max(offset->state.ray.state.blur, base.context.filter_glossy.blur_behind(y.shade.closures, y.wo, event.wi));
  connection.guided_ratio = offset->state.ray.state.guided_ratio * guided_ratio(base.event, y, event.wi);
  offset->shared_vertex->wo = -event.wi;
}

// Returns the state of the ray by which the offset arrives at the shared vertex.
shading::RayState shared_ray_state(const BasePath& base, const OffsetPath& offset, const path::Vertex& z) {
  shading::RayState ray = base.state.ray.state;
  ray.transparent_depth = offset.connection.transparent_depth;
  ray.portal_depth = offset.state.ray.state.portal_depth;
  ray.blur = offset.connection.blur;
  ray.guided_ratio = offset.connection.guided_ratio;
  ray.length = glm::length(z.point.position - offset.vertex->point.position);
  return ray;
}

// Returns whether `z` needs no new shading for the offset. Most walls look the same from all directions.
bool looks_same_from(const OffsetPath& offset, const path::Vertex& z) {
  return z.shade.ignores_wo && sees_same_side(offset, z);
}

// Returns the base's event at the shared vertex, as seen from the offset.
ShiftedEvent shared_event(const BasePath& base, const path::Vertex& z, const path::ScatterEvent& event,
                          OffsetPath* offset) {
  shade_shared_vertex(base, z, offset);
  if (!offset->connection.scatters_alike) {
    return event_towards(event, *offset->shared_vertex, event.sample.wi, 1.0f);
  }
  ShiftedEvent same;
  same.wi = event.sample.wi;
  same.factor = event.factor;
  same.pdf = event.pdf;
  same.ratio = 1.0f;
  return same;
}

// Returns the blur of the base's event at the shared vertex, as seen from the offset.
float shared_blur(const BasePath& base, const path::ScatterEvent& event, const OffsetPath& offset, const Vec3& wi) {
  if (offset.connection.scatters_alike || event.sample.dirac) return event.blur;
  const path::Vertex& z = *offset.shared_vertex;
  return base.context.filter_glossy.blur_behind(z.shade.closures, z.wo, wi);
}

}  // namespace

float area_jacobian(float cosine_base, float distance_base, float cosine_offset, float distance_offset) {
  const float ratio = distance_base / distance_offset;
  return cosine_offset / cosine_base * ratio * ratio;
}

Reconnection reconnect(const Vec3& base, const Vec3& offset, const Vec3& target, const Vec3& target_normal) {
  Reconnection result;
  const Vec3 from_base = target - base;
  const Vec3 from_offset = target - offset;
  const float distance_base = glm::length(from_base);
  result.distance = glm::length(from_offset);
  result.direction = from_offset / result.distance;
  const float cosine_base = std::fabs(glm::dot(target_normal, from_base)) / distance_base;
  const float cosine_offset = std::fabs(glm::dot(target_normal, result.direction));
  result.jacobian = area_jacobian(cosine_base, distance_base, cosine_offset, result.distance);
  if (!(result.jacobian > 0.0f) || !is_finite(result.jacobian)) {
    result.failure = ShiftFailure::Jacobian;
  }
  return result;
}

void connect_pending(const BasePath& base, const path::Vertex& z, OffsetPaths* offsets, film::Counters* counters) {
  const path::PathContext& context = base.context;
  ShiftedEvent events[film::kOffsets];
  bool wanted[film::kOffsets];
  bool any = false;
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = (*offsets)[k];
    wanted[k] = o.stage == OffsetStage::Pending && !o.connection.is_known;
    if (wanted[k]) {
      o.connection = OffsetConnection{};
      o.connection.is_known = true;
      o.connection.transparent_depth = o.state.ray.state.transparent_depth;
      events[k] = reconnection_event(base, o, z);
      wanted[k] = events[k].failure == ShiftFailure::None;
      count_failure(events[k].failure, counters);
      counters->rays_shift_shadow += wanted[k] ? 1 : 0;
      any |= wanted[k];
    }
  }
  const bool traces_packet = !context.has_transparency && context.scene.features.has_uniform_visibility;
  bool blocked[film::kOffsets] = {};
  if (any && traces_packet) {
    const geometry::Lanes3 direction = geometry::lanes(events[0].wi, events[1].wi, events[2].wi, events[3].wi);
    const geometry::Points4 points = offset_points(*offsets, base.camera_sample.time);
    context.scene.occluded4(geometry::spawn_rays_to(points, direction, z.point), wanted, blocked);
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    if (!wanted[k]) {
      continue;
    }
    OffsetPath& o = (*offsets)[k];
    const Rgb transmittance = traces_packet
                                  ? Rgb(blocked[k] ? 0.0f : 1.0f)
                                  : path::segment_transmittance(context, path::spawn_ray_to(o.vertex->point, z.point),
                                                                base.state.ray, &o.connection.transparent_depth);
    if (is_black(transmittance)) {
      ++counters->fail_occluded;
    } else {
      open_connection(base, events[k], transmittance, &o);
    }
  }
}

bool sees_same_side(const OffsetPath& offset, const path::Vertex& z) {
  return glm::dot(z.facing_normal(), offset.shared_vertex->wo) > 0.0f;
}

Rgb shared_emission(const BasePath& base, const OffsetPath& offset, const path::Vertex& z) {
  return looks_same_from(offset, z) ? z.shade.emission
                                    : shading::shade_emission(base.context.scene, z.point, offset.shared_vertex->wo,
                                                              shared_ray_state(base, offset, z));
}

void shade_shared_vertex(const BasePath& base, const path::Vertex& z, OffsetPath* offset) {
  OffsetConnection& connection = offset->connection;
  if (std::exchange(connection.is_shaded, true)) {
    return;
  }
  connection.scatters_alike = looks_same_from(*offset, z);
  if (!connection.scatters_alike) {
    offset->shared_vertex->point = z.point;
    shading::shade_from_tape(base.context.scene, z.point, *z.shade.tape, z.wo, offset->shared_vertex->wo,
                             shared_ray_state(base, *offset, z), base.context.settings.roughness_threshold,
                             &offset->shared_vertex->shade);
  }
}

ShiftFailure reconnect_at(const BasePath& base, const path::Vertex& z, const path::ScatterEvent& event,
                          OffsetPath* offset) {
  const OffsetConnection& connection = offset->connection;
  const ShiftedEvent shifted = shared_event(base, z, event, offset);
  if (shifted.failure != ShiftFailure::None) {
    return shifted.failure;
  }
  if (!(connection.kind_ratio > 0.0f)) {
    return ShiftFailure::Class;
  }
  offset->state.throughput = connection.throughput * shifted.factor;
  offset->state.ray.state.transparent_depth = connection.transparent_depth;
  offset->ratio = connection.ratio * connection.kind_ratio * shifted.ratio;
  offset->kind_ratio = shifted.kind_ratio;
  offset->shared_pdf = shifted.pdf;
  offset->blurs_alike = std::max(connection.blur, shared_blur(base, event, *offset, shifted.wi)) ==
                        std::max(base.state.ray.state.blur, event.blur);
  return ShiftFailure::None;
}

void share_vertex(const BasePath& base, const path::Vertex& z, OffsetPath* offset) {
  shade_shared_vertex(base, z, offset);
  offset->advance_to_shared_vertex();
  offset->state.throughput = offset->connection.throughput;
  offset->state.ray.state.transparent_depth = offset->connection.transparent_depth;
  offset->state.ray.state.blur = offset->connection.blur;
  offset->state.ray.state.guided_ratio = offset->connection.guided_ratio;
  offset->ratio = offset->connection.ratio;
  offset->kind_ratio = offset->connection.kind_ratio;
  offset->copies_class_choice = false;
  offset->stage = OffsetStage::Coupled;
}

}  // namespace gradus::gradient
