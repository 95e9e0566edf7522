// Segments that offsets trace themselves, before they share those of the base.
#include <utility>

#include "base/fault.h"
#include "gradient/class_match.h"
#include "gradient/offset_paths.h"

namespace gradus::gradient {

// Traces an offset's ray. `first` is its nearest hit, or null if it is unknown. seen() compares the emission on the two
// segments in any case.
void OffsetPaths::trace(OffsetPath* o, const geometry::Hit* first) {
  o->advance();
  o->fresh = true;
  if (path::shows_only_lights(context_, base_state_)) {
    counters_.rays_shift += path::trace_to_lights(context_, o->state.ray, &o->traced_segment) ? 1 : 0;
    return;
  }
  ++counters_.rays_shift;
  path::trace_segment(context_, *sampler_, base_state_.depth, first, &o->state.ray, o->here, &o->traced_segment,
                      path::Shading::Later);
}

// Returns the camera vertex of the pixel of offset k, or null if it is not known. In the base's pixel block, an
// offset's camera ray equals that of the base path of its own pixel.
path::CameraVertex* OffsetPaths::known_vertex(int k) const {
  const int32_t x = sample_->x + film::kOffsetX[k], y = sample_->y + film::kOffsetY[k];
  const bool same_block = film::pixel_block_of(x) == film::pixel_block_of(sample_->x) &&
                          film::pixel_block_of(y) == film::pixel_block_of(sample_->y);
  return sample_->first != nullptr && same_block ? vertices_.at(x, y) : nullptr;
}

void OffsetPaths::share(OffsetPath* o, path::CameraVertex* v) {
  o->here = &v->vertex;
  o->segment = &v->segment;
  o->camera = v;
  o->state.ray = v->ray;
  o->fresh = true;
}

// Traces the camera rays of the offsets. They have the base's position in the pixel, point on the lens and time, so the
// camera's factor of r is 1. With a lens the four rays are traced together. Without one most rays are known, and a
// packet for the one that leaves the pixel block would take as long as three single rays.
void OffsetPaths::trace_camera(const path::PathState& state) {
  Ray rays[film::kOffsets];
  geometry::Hit hits[film::kOffsets];
  bool unknown[film::kOffsets];
  bool any = false;
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    rays[k] = kNoRay;
    unknown[k] = false;
    if (o.stage != OffsetStage::Traced) {
      continue;
    }
    path::CameraVertex* known = known_vertex(k);
    if (known != nullptr && known->shared) {
      share(&o, known);
      continue;
    }
    o.state.ray = path::PathRay{};
    o.state.ray.visibility = state.ray.visibility;
    camera::CameraSample moved = camera_sample_.moved(Vec2(film::kOffsetX[k], film::kOffsetY[k]));
    if (GRADUS_FAULT(offset_rays_lose_time)) moved.time = 0.0f;
    if (GRADUS_FAULT(offset_rays_lose_lens)) moved.lens = Vec2(0.0f);
    o.state.ray.ray = context_.camera.ray(moved);
    if (sample_->first != nullptr) {
      trace(&o, known != nullptr ? &known->hit : nullptr);
    } else {
      rays[k] = o.state.ray.ray;
      any = unknown[k] = true;
    }
  }
  if (any) {
    context_.scene.intersect4(rays, state.ray.visibility, hits);
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    if (unknown[k]) {
      trace(&offsets_[k], &hits[k]);
    }
  }
}

void OffsetPaths::include_kind(OffsetPath* o) {
  o->ratio *= std::exchange(o->kind_ratio, 1.0f);
  if (!(o->ratio > 0.0f)) {
    fail(o, ShiftFailure::Class);
  }
}

// Lets the offset scatter by `event`. Its new ray has the ray state of the base's, except for the count of transparent
// surfaces.
void OffsetPaths::leave(OffsetPath* o, const ShiftedEvent& event, const path::PathState& state) {
  const uint16_t transparent_depth = o->state.ray.state.transparent_depth;
  o->state.ray = state.ray;
  o->state.ray.state.transparent_depth = transparent_depth;
  o->state.ray.ray = path::spawn_ray(o->here->point, event.wi);
  o->state.depth = state.depth;
  o->state.lpe_state = state.lpe_state;
  o->state.throughput *= event.factor;
  o->ratio *= event.ratio;
  o->kind_ratio = event.kind_ratio;
  o->event.pdf = event.pdf;
  o->from_camera = false;
}

// Copies the base's last event, of class R or T, to the last vertices of the offsets. Behind glass the rays diverge, so
// single rays are faster than a packet.
void OffsetPaths::copy_events(const path::RaySource& source, const path::PathState& state) {
  for (OffsetPath& o : offsets_) {
    if (o.stage != OffsetStage::Traced) {
      continue;
    }
    // Attempts are counted; there are none in a scene for which the planner skips these shifts.
    ++counters_.shifts_half_vector;
    const ShiftedEvent event = copy_event(*source.vertex, *source.event, *o.here);
    if (event.failure != ShiftFailure::None) {
      fail(&o, event.failure);
      continue;
    }
    leave(&o, event, state);
    o.event.sample.dirac = source.event->sample.dirac;
    trace(&o, nullptr);
  }
}

// Traces a ray of the offset's own after class D. Returns false, and fails the shift, if the ray meets no surface.
bool OffsetPaths::trace_surface(OffsetPath* o, const ShiftedEvent& event) {
  ++counters_.shifts_replayed;  // counts attempts
  if (event.failure != ShiftFailure::None) {
    fail(o, event.failure);
    return false;
  }
  ++counters_.rays_shift;
  leave(o, event, base_state_);
  o->event.sample.dirac = false;
  o->advance();
  path::trace_segment(context_, *sampler_, base_state_.depth, nullptr, &o->state.ray, o->here, &o->traced_segment);
  if (o->segment->end != path::SegmentEnd::Surface) {
    fail(o, ShiftFailure::Missed);
    return false;
  }
  o->state.throughput *= o->segment->weight;
  return true;
}

// Copies the base's direction at class D before class R or T to the offset, which then does not share the base's
// vertex. Fails if the inverse shift would share the vertex.
void OffsetPaths::copy_direction(OffsetPath* o, const path::ScatterEvent& next) {
  if (!trace_surface(o, event_towards(base_event_, *o->here, base_event_.sample.wi, 1.0f))) {
    return;
  }
  const Vec3& y = o->previous->point.position;
  if (replays(y, *o->here) || shares(y, *o->here, next.scatter_class) || shares_direction(y, *o->here, next)) {
    fail(o, ShiftFailure::Class);
    return;
  }
  o->stage = OffsetStage::Traced;
  o->mixed = false;
  include_kind(o);
}

// Returns whether class D before z over a short edge is shifted by random replay. It is not at a surface that is only
// sharp: there the direction is copied, and the inverse shift may do the same.
bool OffsetPaths::replays(const Vec3& y, const path::Vertex& z) const {
  const bool non_specular = z.shade.closures.class_probability(bsdf::ScatterClass::Diffuse) > 0.0f;
  return non_specular && is_short_edge(base_position_, y, z.point.position);
}

void OffsetPaths::replay_short_edges(const path::Vertex& vertex) {
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending && replays(o.here->point.position, vertex)) {
      replay(&o, vertex);
    }
  }
}

// Replays the base's last event at the offset with the same random numbers. Fails if the inverse shift would not be a
// replay.
void OffsetPaths::replay(OffsetPath* o, const path::Vertex& vertex) {
  if (!trace_surface(o, replay_event(*base_from_, base_event_, sampler_->vertex(base_state_.depth - 1), *o->here))) {
    return;
  }
  if (!replays(o->previous->point.position, *o->here)) {
    fail(o, ShiftFailure::Class);
    return;
  }
  o->stage = OffsetStage::Traced;
  o->mixed = !same_classes(vertex.shade.closures, o->here->shade.closures);
  include_kind(o);
}

}  // namespace gradus::gradient
