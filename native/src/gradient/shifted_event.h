// A scattering event of the base path, shifted to a vertex of the offset path: the result of all shift strategies.
#pragma once

#include "film/film.h"
#include "path/scatter.h"

namespace gradus::gradient {

enum class ShiftFailure : uint8_t { None, Missed, Occluded, Class, TotalReflection, Side, Density, Jacobian };
// Increments the counter of a failed shift; does nothing for ShiftFailure::None.
void count_failure(ShiftFailure cause, film::Counters* counters);

struct ShiftedEvent {
  Vec3 wi = Vec3(0.0f);
  Rgb factor = Rgb(0.0f);  // BSDF value times cosine, divided by `pdf`
  float pdf = 0.0f;        // P(class)·p(direction | class)
  float ratio = 0.0f;      // factor of this event in the ratio r: J·pdf'/pdf with the Jacobian J in solid angle
  // Factor of r for the kind of the bounce, P'(kind | direction)/P(kind | direction). It applies only where the kind
  // matters. The limits on bounces depend on the kind, so it applies to everything behind the next vertex. Where
  // emitters depend on the kind too, it is part of `ratio` instead. It is 0 if the offset has no bounce of this kind in
  // this direction.
  float kind_ratio = 1.0f;
  ShiftFailure failure = ShiftFailure::None;
};

inline ShiftedEvent failed_event(ShiftFailure failure) {
  ShiftedEvent event;
  event.failure = failure;
  return event;
}

// Returns the event at y with BSDF value `value` and density `pdf` in direction wi, where the shift of `event` has the
// given Jacobian. Fails if the sampler at y cannot produce it, so that the inverse shift could not start from it.
ShiftedEvent weigh_event(const path::ScatterEvent& event, const Vec3& wi, const Rgb& value, float pdf, float jacobian);
// Returns the event at y with the known direction wi and Jacobian. Evaluates the class, value and density of `event` at
// y.
ShiftedEvent event_towards(const path::ScatterEvent& event, const path::Vertex& y, const Vec3& wi, float jacobian);

// Returns the density of the event at y with direction wi over that without a guide.
inline float guided_ratio(const path::ScatterEvent& event, const path::Vertex& y, const Vec3& wi) {
  return y.shade.closures.guided_ratio(event.scatter_class, y.wo, wi, event.sampled_kind());
}

// Returns whether wi lies on the other side of the surface than the outgoing direction.
inline bool is_transmission(const path::Vertex& vertex, const Vec3& wi) {
  return glm::dot(vertex.facing_normal(), wi) < 0.0f;
}

// Returns whether events of class c are shifted by reconnection at the next vertex (class D) instead of a copy of the
// event (classes R and T). The shift copies the class, so base and offset make the same decision.
inline bool reconnects(bsdf::ScatterClass c) { return c == bsdf::ScatterClass::Diffuse; }

}  // namespace gradus::gradient
