// Reconnection of offsets to the base's next vertex.
#include <utility>

#include "gradient/offset_paths.h"

namespace gradus::gradient {

// Computes the reconnection of an offset to the base's vertex, apart from visibility.
ShiftFailure OffsetPaths::try_reconnection(OffsetPath* o, const path::Vertex& vertex, ShiftedEvent* event) const {
  const Reconnection connection =
      reconnect(base_position_, o->here->point.position, vertex.point.position, vertex.point.geometric_normal);
  if (connection.failure != ShiftFailure::None) {
    return connection.failure;
  }
  *event = event_towards(base_event_, *o->here, connection.direction, connection.jacobian);
  return event->failure;
}

// Stores the connection of an offset to the shared vertex. The base's decisions at transparent surfaces on its segment
// apply to both paths, so the transparent surfaces of the offset's own segment are weighted by their expectation.
void OffsetPaths::open_connection(OffsetPath* o, const ShiftedEvent& event, const Rgb& through) {
  o->connection.open = true;
  o->connection.throughput = o->state.throughput * event.factor * through / base_segment_->probability;
  o->connection.ratio = o->ratio * event.ratio;
  o->connection.kind_ratio = event.kind_ratio;
  o->connection.pdf = event.pdf;
  o->reconnected->wo = -event.wi;
}

// Returns the state of the ray by which the offset arrives at the shared vertex.
shading::RayState OffsetPaths::reconnected_ray(const OffsetPath& o, const path::Vertex& vertex) const {
  shading::RayState ray = base_state_.ray.state;
  ray.transparent_depth = o.connection.transparent_depth;
  ray.length = glm::length(vertex.point.position - o.here->point.position);
  return ray;
}

// Returns the emission of the shared vertex towards the offset. It does not evaluate closures, which may not be needed.
Rgb OffsetPaths::reconnected_emission(const OffsetPath& o, const path::Vertex& vertex) const {
  const bool same = vertex.shade.ignores_wo && glm::dot(vertex.facing_normal(), o.reconnected->wo) > 0.0f;
  return same ? vertex.shade.emission
              : shading::shade_emission(context_.scene, vertex.point, o.reconnected->wo, reconnected_ray(o, vertex));
}

// Shades the shared vertex as seen from the offset; its closures are known. Most walls look the same from all
// directions and need no new shading.
void OffsetPaths::shade_reconnected(OffsetPath* o, const path::Vertex& vertex) const {
  if (std::exchange(o->connection.shaded, true)) {
    return;
  }
  o->connection.looks_same = vertex.shade.ignores_wo && glm::dot(vertex.facing_normal(), o->reconnected->wo) > 0.0f;
  if (!o->connection.looks_same) {
    o->reconnected->point = vertex.point;
    shading::shade_from_tape(context_.scene, vertex.point, *vertex.shade.tape, vertex.wo, o->reconnected->wo,
                             reconnected_ray(*o, vertex), context_.settings.roughness_threshold,
                             &o->reconnected->shade);
  }
}

// Returns the base's event at the shared vertex, as seen from the offset.
ShiftedEvent OffsetPaths::reconnected_event(OffsetPath* o, const path::Vertex& vertex,
                                            const path::ScatterEvent& event) const {
  shade_reconnected(o, vertex);
  if (!o->connection.looks_same) {
    return event_towards(event, *o->reconnected, event.sample.wi, 1.0f);
  }
  ShiftedEvent same;
  same.wi = event.sample.wi;
  same.factor = event.factor;
  same.pdf = event.pdf;
  same.ratio = 1.0f;
  return same;
}

// Connects all pending offsets that have no connection yet to the base's vertex.
void OffsetPaths::reconnect_all(const path::Vertex& vertex) {
  ShiftedEvent events[film::kOffsets];
  bool wanted[film::kOffsets];
  bool any = false;
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    wanted[k] = o.stage == OffsetStage::Pending && !o.connection.known;
    if (wanted[k]) {
      o.connection = OffsetConnection{};
      o.connection.known = true;
      o.connection.transparent_depth = o.state.ray.state.transparent_depth;
      const ShiftFailure failure = try_reconnection(&o, vertex, &events[k]);
      wanted[k] = failure == ShiftFailure::None;
      count_failure(&counters_, failure);
      counters_.rays_shift_shadow += wanted[k] ? 1 : 0;
      any |= wanted[k];
    }
  }
  const bool packet = !context_.has_transparency && context_.uniform_visibility;
  bool blocked[film::kOffsets] = {};
  if (any && packet) {
    const geometry::Lanes3 direction = geometry::lanes(events[0].wi, events[1].wi, events[2].wi, events[3].wi);
    context_.scene.occluded4(geometry::spawn_rays_to(offset_points(), direction, vertex.point), wanted, blocked);
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    if (!wanted[k]) {
      continue;
    }
    OffsetPath& o = offsets_[k];
    const Rgb through = packet ? Rgb(blocked[k] ? 0.0f : 1.0f)
                               : path::segment_transmittance(context_, path::spawn_ray_to(o.here->point, vertex.point),
                                                             base_state_.ray, &o.connection.transparent_depth);
    if (is_black(through)) {
      ++counters_.fail_occluded;
    } else {
      open_connection(&o, events[k], through);
    }
  }
}

// Returns whether the offset has a connection to the shared vertex on the side that the base sees. Fails the offset if
// not.
bool OffsetPaths::arrives(OffsetPath* o, const path::Vertex& vertex) {
  if (!o->connection.open) {
    finalize(o, OffsetStage::Failed);  // reconnect_all() has counted the cause
  } else if (!(glm::dot(vertex.facing_normal(), o->reconnected->wo) > 0.0f)) {
    fail(o, ShiftFailure::Side);
  }
  return o->stage == OffsetStage::Pending;
}

bool OffsetPaths::shares(const Vec3& y, const path::Vertex& z, bsdf::ScatterClass next) const {
  return shares_sharp_vertex(base_position_, y, z.point.position, context_.scene.curvature(z.point.hit),
                             next == bsdf::ScatterClass::Transmission);
}

// Returns whether the lobe of the event at z looks alike from the base's vertex and from y, so that they can share its
// direction.
bool OffsetPaths::shares_direction(const Vec3& y, const path::Vertex& z, const path::ScatterEvent& event) const {
  const float width = event.sample.dirac ? 0.0f : class_width(z.shade.closures, event.scatter_class);
  return looks_similar(base_position_, y, z.point.position, width);
}

// Shifts class D before class R or T. The offset shares the base's vertex, and also its direction where the lobe is
// wide, or it continues with a ray of its own. Where a texture depends on the ray, the two paths may judge the lobe
// differently. The inverse shift would then differ too, so the shift fails.
void OffsetPaths::reach_sharp(const path::Vertex& vertex, const path::ScatterEvent& event) {
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending && !shares(o.here->point.position, vertex, event.scatter_class) &&
        !shares_direction(o.here->point.position, vertex, event)) {
      copy_direction(&o, event);
    }
  }
  reconnect_all(vertex);
  for (OffsetPath& o : offsets_) {
    if (o.stage != OffsetStage::Pending || !arrives(&o, vertex)) {
      continue;
    }
    shade_reconnected(&o, vertex);
    const Vec3& y = o.here->point.position;
    const bool looks_same = shares_direction(y, vertex, event);
    if (looks_same != shares_direction(y, *o.reconnected, event)) {
      fail(&o, ShiftFailure::Class);
    } else if (looks_same) {
      reconnect_at(&o, vertex, event);
    } else {
      share_vertex(&o, vertex);
    }
  }
}

// Makes the base's vertex, as seen from the offset, a vertex of the offset, at which the event will be copied.
void OffsetPaths::share_vertex(OffsetPath* o, const path::Vertex& vertex) {
  ++counters_.shifts_reconnected;
  shade_reconnected(o, vertex);
  o->advance_to_reconnected();
  o->state.throughput = o->connection.throughput;
  o->state.ray.state.transparent_depth = o->connection.transparent_depth;
  o->ratio = o->connection.ratio;
  o->kind_ratio = o->connection.kind_ratio;
  o->mixed = false;
  o->stage = OffsetStage::Traced;
  include_kind(o);
}

void OffsetPaths::scatter(const path::Vertex& vertex, const path::VertexSample& u, const path::ScatterEvent& event) {
  scale(event.factor);
  if (open_ == 0) {
    return;
  }
  decouple_by_class(vertex, u);
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Deeper) {
      o.state.throughput *= event.factor;
    }
  }
  if (!any(OffsetStage::Pending)) {
    return;
  }
  if (!reconnects(event.scatter_class)) {
    reach_sharp(vertex, event);
    return;
  }
  if (may_defer()) {
    defer(vertex, event);
    return;
  }
  reconnect_all(vertex);
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending && arrives(&o, vertex)) {
      reconnect_at(&o, vertex, event);
    }
  }
}

// Reconnects the offset at the base's vertex; both share the rest of the path.
void OffsetPaths::reconnect_at(OffsetPath* o, const path::Vertex& vertex, const path::ScatterEvent& event) {
  const ShiftedEvent shared = reconnected_event(o, vertex, event);
  if (shared.failure != ShiftFailure::None) {
    fail(o, shared.failure);
    return;
  }
  if (!(o->connection.kind_ratio > 0.0f)) {
    fail(o, ShiftFailure::Class);
    return;
  }
  ++counters_.shifts_reconnected;
  o->state.throughput = o->connection.throughput * shared.factor;
  o->state.ray.state.transparent_depth = o->connection.transparent_depth;
  o->ratio = o->connection.ratio * o->connection.kind_ratio * shared.ratio;
  o->kind_ratio = shared.kind_ratio;
  o->shared_pdf = shared.pdf;
  if (o->connection.looks_same) {
    join(o);  // both paths have the same density at the vertex
  } else {
    o->stage = OffsetStage::Reconnected;
  }
}

}  // namespace gradus::gradient
