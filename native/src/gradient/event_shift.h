// Replaying one scattering event of the base at the offset's own vertex: Dirac events by the same lobe, sharp ones by
// their half-vector, rough ones by their direction.
#pragma once

#include "gradient/half_vector.h"
#include "path/scatter.h"

namespace gradus::gradient {

// The event at the offset vertex.
struct ShiftedEvent {
  Vec3 wi = Vec3(0.0f);
  Rgb factor = Rgb(0.0f);  // value / pdf
  float pdf = 0.0f;        // P(class)·p(direction | class)
  float ratio = 0.0f;      // the event's factor of r: J·pdf'/pdf
  // And the factor of r for the kind of the bounce, P'(kind | direction)/P(kind | direction), which counts from where
  // it matters: for what lies behind the next vertex, because limits on bounces depend on it; where emitters do, too,
  // it is part of `ratio`. 0: the offset makes no such bounce in this direction.
  float kind_ratio = 1.0f;
  ShiftFailure failure = ShiftFailure::None;
};

// A class R or T event of the base at x, replayed at y. J = 1 for Dirac events.
ShiftedEvent copy_event(const path::Vertex& x, const path::ScatterEvent& event, const path::Vertex& y);
// Random replay: the event that the numbers u, which made the base's, make at y. They are the coordinates of the path:
// J·pdf'/pdf = P'/P.
ShiftedEvent replay_event(const path::Vertex& x, const path::ScatterEvent& event, const path::VertexSample& u,
                          const path::Vertex& y);
// The event with a known direction wi' and Jacobian: evaluates class, value and density at y.
ShiftedEvent event_towards(const path::ScatterEvent& event, const path::Vertex& y, const Vec3& wi, float jacobian);

// Whether the rule of the class is a reconnection at the next vertex (rough, class D) or a copy of the event (sharp, R
// and T). The class is copied, so base and offset decide alike.
inline bool reconnects(bsdf::ScatterClass c) { return c == bsdf::ScatterClass::Diffuse; }

}  // namespace gradus::gradient
