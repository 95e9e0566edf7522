// Filter Glossy: blurs the glossy lobes behind events that scatter light widely, as Cycles does.
//
// Cycles keeps the smallest density p by which the path has chosen a direction, and raises the alphas of the lobes that
// the path meets to ½·√(1 − p/s), where s is the strength of the filter. Dirac events and the camera have p = ∞.
// Behind a diffuse bounce, p is at most 1/π.
//
// The closures of a vertex thus depend on the path before it, and the value of a path is f(x, b(x)), where b are the
// blurs. A gradient is the difference of two such pictures. An offset path y must therefore have the value f(y, b(y))
// with blurs of its own. With those of its base, f(y, b(x)), the base samples of one pixel and those of its neighbour
// would disagree about the value of the same pair (x, y). Their sum would lack the part of the gradient that comes from
// b(y) − b(x), so it would be biased.
//
// But paths that have joined must agree about all vertices behind, or every vertex would be shaded again for each
// offset. So p is rounded to few values. All diffuse densities are one, with the mean that they have in cosine-weighted
// directions, and above it there is one to each octave. It is also the smallest, so that one diffuse event makes the
// blurs of both paths equal. Where the blurs behind the joint differ, the shift ends there. That depends on the pair
// alone, so that the inverse shift ends at the same vertex, and both stay one-to-one (gradient/reconnection.h).
#pragma once

#include "bsdf/closures.h"

namespace gradus::path {

class FilterGlossy {
 public:
  // Maximum of all blurs, as an alpha.
  static constexpr float kMaxBlur = 0.5f;

  // A strength of 0 switches the filter off.
  explicit FilterGlossy(float strength);

  // Returns the blur of an event with this density.
  float blur_of(float pdf) const;
  // Returns the blur of an event in direction wi that is not Dirac.
  float blur_behind(const bsdf::Closures& closures, const Vec3& wo, const Vec3& wi) const;

 private:
  float strength_;
  float widest_;  // blur of all diffuse events
};

}  // namespace gradus::path
