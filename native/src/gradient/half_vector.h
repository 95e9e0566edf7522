// Half-vector copy: the shift of specular reflections and refractions (Manzi 2016, section 5.4.2, step 2).
//
// Dirac events keep their lobe. Otherwise the half-vector keeps its coordinates in the frame of the surface. The frame
// of the offset vertex is that of the base vertex, turned by the smallest rotation between the two normals, because
// frames from UV maps are discontinuous at seams. The base samples its direction in solid angle. So the Jacobian of the
// shift is the ratio of the derivatives of the map half-vector -> direction at a fixed incident direction (Walter et
// al. 2007, equations 14 and 17):
//   reflection  dω/dh = 4 |ω·h|
//   refraction  dω/dh = |wo + η ω|² / (η² |ω·h|),  h ∝ wo + η ω,  η = index of the far side over that of wo
// This gives J = (dω'/dh') / (dω/dh). If the two vertices separate different media, η' differs from η, and J contains
// the factor (η/η')².
#pragma once

#include "gradient/shifted_event.h"

namespace gradus::gradient {

// Outgoing direction and surface at one vertex of a half-vector copy.
struct HalfVectorFrame {
  Vec3 wo = Vec3(0.0f);
  Vec3 normal = Vec3(0, 0, 1);  // unit vector that depends only on the vertex and the class
  float eta = 1.0f;  // index of refraction of the far side over that of the side of wo; used by refraction only
};

struct ShiftedDirection {
  Vec3 wi = Vec3(0.0f);
  float jacobian = 0.0f;  // |∂wi'/∂wi| in solid angle
  ShiftFailure failure = ShiftFailure::None;
};

// Maps the direction wi at `base` to the direction wi' with the same half-vector at `offset`, as a refraction if
// `transmitted`, else as a reflection. All directions are unit vectors. The same call with the frames exchanged is the
// inverse. Sets `failure` to Side, TotalReflection or Jacobian if no such direction exists.
ShiftedDirection copy_half_vector(const HalfVectorFrame& base, const Vec3& wi, const HalfVectorFrame& offset,
                                  bool transmitted);

// Applies to v the smallest rotation that takes the unit vector `from` to the unit vector `to`. The call with `from`
// and `to` exchanged is the inverse.
Vec3 rotate_between(const Vec3& from, const Vec3& to, const Vec3& v);

// Returns the roughness (alpha) of the sharpest lobe of class c that is not Dirac, or infinity if there is none.
float class_width(const bsdf::Closures& closures, bsdf::ScatterClass c);
// Returns the frame for half-vectors of class c at a vertex, which is that of its first lobe that is not Dirac.
HalfVectorFrame class_frame(const bsdf::Closures& closures, bsdf::ScatterClass c, const Vec3& wo);

// Copies an event of class R or T at the base vertex x to the offset vertex y. Fails if y has no such event.
ShiftedEvent copy_event(const path::Vertex& x, const path::ScatterEvent& event, const path::Vertex& y);

}  // namespace gradus::gradient
