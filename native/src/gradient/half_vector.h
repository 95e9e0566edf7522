// Half-vector copy: the shift at sharp reflections and refractions (thesis 5.4.2).
//
// The half-vector of the base keeps its coordinates in the frame of the surface, where the frame follows the normal by
// the smallest rotation (frames from UV maps jump at seams). With the base's direction sampled in solid angle, the
// shift's Jacobian is the ratio of the two maps half-vector -> direction, incident direction fixed (Walter et al. 2007,
// equations 14 and 17):
//   reflection  dω/dh = 4 |ω·h|
//   refraction  dω/dh = |wo + η ω|² / (η² |ω·h|),  h ∝ wo + η ω,  η = index of the far side over that of wo
// so that J = (dω'/dh') / (dω/dh). Between two media pairs η' differs from η: the factor (η/η')² is part of it.
#pragma once

#include "bsdf/closures.h"

namespace gradus::gradient {

enum class ShiftFailure : uint8_t { None, Missed, Occluded, Class, TotalReflection, Side, Density, Jacobian };

// Surface side of a half-vector copy.
struct HalfVectorFrame {
  Vec3 wo = Vec3(0.0f);
  Vec3 normal = Vec3(0, 0, 1);  // any unit vector that belongs to the vertex and the class
  float eta = 1.0f;             // refraction: index of the far side over that of wo
};

struct ShiftedDirection {
  Vec3 wi = Vec3(0.0f);
  float jacobian = 0.0f;  // |∂wi'/∂wi| in solid angle
  ShiftFailure failure = ShiftFailure::None;
};

// base.wo, wi -> wi' at `offset`. transmitted: refraction. Inverse: the same call with the frames exchanged.
ShiftedDirection copy_half_vector(const HalfVectorFrame& base, const Vec3& wi, const HalfVectorFrame& offset,
                                  bool transmitted);

// Smallest rotation that takes unit vector `from` to `to`, applied to v. Its inverse exchanges from and to.
Vec3 rotate_between(const Vec3& from, const Vec3& to, const Vec3& v);

// Roughness (alpha) of the class's sharpest lobe that is not Dirac; infinite where it has none.
float class_width(const bsdf::Closures& closures, bsdf::ScatterClass c);
// The frame of a class's half-vectors at a vertex: that of its first lobe that is not Dirac.
HalfVectorFrame class_frame(const bsdf::Closures& closures, bsdf::ScatterClass c, const Vec3& wo);

}  // namespace gradus::gradient
