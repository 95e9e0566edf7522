#include "geometry/rays4.h"

#include <immintrin.h>

namespace gradus::geometry {

namespace {

using Bits = int32_t __attribute__((vector_size(16)));

Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr int32_t kSign = INT32_MIN;

// Returns the float next to v in the direction of the sign of `up`, for each lane; v where `up` is 0. The same function
// for one value is in surface.cpp.
Lanes step_away(const Lanes& v, const Lanes& up) {
  const Bits up_bits = (Bits)up;
  const Bits bits = v == 0.0f ? up_bits & kSign : (Bits)v;
  const Bits away = bits + (((bits ^ up_bits) >> 31) | 1);
  return up == 0.0f ? v : (Lanes)away;
}

// Returns the same point in all lanes.
Points4 gather(const SurfacePoint& p) {
  return {same(p.position), same(p.geometric_normal), same(p.error), p.hit.time};
}

}  // namespace

Lanes3 offset_origins(const Points4& points, const Lanes3& direction) {
  const Bits sign = (Bits)dot(points.normal, direction) & kSign;
  const Lanes3 offset = points.normal * (Lanes)((Bits)points.error | sign);
  const Lanes3 p = points.position + offset;
  return {step_away(p.x, offset.x), step_away(p.y, offset.y), step_away(p.z, offset.z)};
}

Points4 gather(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, const SurfacePoint& d, float time) {
  return {lanes(a.position, b.position, c.position, d.position),
          lanes(a.geometric_normal, b.geometric_normal, c.geometric_normal, d.geometric_normal),
          Lanes{a.error, b.error, c.error, d.error}, time};
}

Rays4 spawn_rays_to(const Points4& from, const Lanes3& direction, const SurfacePoint& to) {
  return rays_between(offset_origins(from, direction), offset_origins(gather(to), -direction), direction, from.time);
}

Rays4 rays_between(const Lanes3& start, const Lanes3& end, const Lanes3& direction, float time) {
  const Lanes3 line = end - start;
  const Lanes length = _mm_sqrt_ps(dot(line, line));
  const Bits ahead = (length > 0.0f) & (dot(line, direction) > 0.0f);
  return {start, line * (1.0f / length), ahead ? length * (1.0f - 1e-6f) : same(-1.0f), time};
}

}  // namespace gradus::geometry
