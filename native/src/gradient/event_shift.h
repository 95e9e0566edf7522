// Replays one scattering event of the base path at the vertex of an offset path. Dirac events keep their lobe, sharp
// events their half-vector, and rough events their direction.
#pragma once

#include "gradient/half_vector.h"
#include "path/scatter.h"

namespace gradus::gradient {

// A scattering event of the base path, shifted to the vertex of the offset path.
struct ShiftedEvent {
  Vec3 wi = Vec3(0.0f);
  Rgb factor = Rgb(0.0f);  // BSDF value times cosine, divided by `pdf`
  float pdf = 0.0f;        // P(class)·p(direction | class)
  float ratio = 0.0f;      // factor of this event in the ratio r: J·pdf'/pdf
  // Factor of r for the kind of the bounce, P'(kind | direction)/P(kind | direction). It applies only where the kind
  // matters. The limits on bounces depend on the kind, so it applies to everything behind the next vertex. Where
  // emitters depend on the kind too, it is part of `ratio` instead. It is 0 if the offset has no bounce of this kind in
  // this direction.
  float kind_ratio = 1.0f;
  ShiftFailure failure = ShiftFailure::None;
};

// Copies an event of class R or T at the base vertex x to the offset vertex y. Dirac events have J = 1. Sets `failure`
// if y has no such event.
ShiftedEvent copy_event(const path::Vertex& x, const path::ScatterEvent& event, const path::Vertex& y);
// Applies random replay: samples the event at y with the random numbers u that produced `event` at x. These numbers are
// the coordinates of the path, so J·pdf'/pdf = P'/P with the probabilities of the class. Sets `failure` if the class,
// kind or side of the two events differs.
ShiftedEvent replay_event(const path::Vertex& x, const path::ScatterEvent& event, const path::VertexSample& u,
                          const path::Vertex& y);
// Returns the event at y with the known direction wi and Jacobian. Evaluates the class, value and density of `event` at
// y.
ShiftedEvent event_towards(const path::ScatterEvent& event, const path::Vertex& y, const Vec3& wi, float jacobian);

// Returns whether class c is shifted by reconnection at the next vertex (rough, class D) instead of a copy of the event
// (sharp, classes R and T). The shift copies the class, so base and offset make the same decision.
inline bool reconnects(bsdf::ScatterClass c) { return c == bsdf::ScatterClass::Diffuse; }

}  // namespace gradus::gradient
