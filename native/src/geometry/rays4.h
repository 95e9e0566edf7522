// Four rays at once, one in each SIMD lane. The arithmetic is that of the functions for one ray in surface.h, up to
// rounding.
#pragma once

#include "geometry/surface.h"

namespace gradus::geometry {

// Four floats in one SSE register.
using Lanes = float __attribute__((vector_size(16)));

// Four 3D vectors, one in each lane.
struct Lanes3 {
  Lanes x, y, z;
};

// same() returns the value in all lanes.
inline Lanes same(float v) { return Lanes{v, v, v, v}; }
inline Lanes3 same(const Vec3& v) { return {same(v.x), same(v.y), same(v.z)}; }
inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lanes3 operator-(const Lanes3& a) { return {-a.x, -a.y, -a.z}; }
inline Lanes3 operator*(const Lanes3& a, const Lanes& b) { return {a.x * b, a.y * b, a.z * b}; }
// Returns one vector in each lane. The lanes are written at once: four separate stores followed by one wide load would
// stall the processor's store forwarding.
inline Lanes3 lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return {Lanes{a.x, b.x, c.x, d.x}, Lanes{a.y, b.y, c.y, d.y}, Lanes{a.z, b.z, c.z, d.z}};
}

// Sets lane k of `out`.
inline void set_lane(int k, const Vec3& v, Lanes3* out) {
  out->x[k] = v.x;
  out->y[k] = v.y;
  out->z[k] = v.z;
}

// Four rays from t = 0 to t_max. A ray is empty if t_max < 0.
struct Rays4 {
  Lanes3 origin, direction;
  Lanes t_max;
  float time = 0.0f;  // shutter time of all four rays
};

// The data of four surface points that the rays leaving them need.
struct Points4 {
  Lanes3 position, normal;
  Lanes error;
  float time = 0.0f;  // shutter time of all four points: offset paths have the time of their base path
};
// Combines four surface points. `time` is the shutter time of all of them.
Points4 gather(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, const SurfacePoint& d, float time);

// Returns the rays from each point of `from` to the point `to`, with both ends offset from their surfaces. `direction`
// is the unit vector from each point of `from` to `to`.
Rays4 spawn_rays_to(const Points4& from, const Lanes3& direction, const SurfacePoint& to);
// Computes offset_origin() of each point.
Lanes3 offset_origins(const Points4& points, const Lanes3& direction);
// Computes ray_between() of each lane, for ends that are already offset from their surfaces. `direction` is the unit
// vector from start to end.
Rays4 rays_between(const Lanes3& start, const Lanes3& end, const Lanes3& direction, float time);

}  // namespace gradus::geometry
