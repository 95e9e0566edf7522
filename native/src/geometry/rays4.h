// Four rays to one point, one in each lane: the same arithmetic as for one (surface.h, emitters.h), up to rounding.
#pragma once

#include "geometry/surface.h"

namespace gradus::geometry {

using Lanes = float __attribute__((vector_size(16)));

struct Lanes3 {
  Lanes x, y, z;
};

inline Lanes same(float v) { return Lanes{v, v, v, v}; }
inline Lanes3 same(const Vec3& v) { return {same(v.x), same(v.y), same(v.z)}; }
inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lanes3 operator-(const Lanes3& a) { return {-a.x, -a.y, -a.z}; }
inline Lanes3 operator*(const Lanes3& a, const Lanes& b) { return {a.x * b, a.y * b, a.z * b}; }
// Written at once: lanes that are stored one by one and loaded together stall.
inline Lanes3 lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return {Lanes{a.x, b.x, c.x, d.x}, Lanes{a.y, b.y, c.y, d.y}, Lanes{a.z, b.z, c.z, d.z}};
}

inline void set_lane(int k, const Vec3& v, Lanes3* out) {
  out->x[k] = v.x;
  out->y[k] = v.y;
  out->z[k] = v.z;
}

// From t = 0; empty where t_max < 0.
struct Rays4 {
  Lanes3 origin, direction;
  Lanes t_max;
  float time = 0.0f;  // of all
};

// Of four surface points, what rays that leave them need.
struct Points4 {
  Lanes3 position, normal;
  Lanes error;
  float time = 0.0f;  // of all: offsets copy their base's
};
Points4 gather(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, const SurfacePoint& d, float time);

// The rays between surface points, both ends off their surfaces; direction: from `from` to `to`.
Rays4 spawn_rays_to(const Points4& from, const Lanes3& direction, const SurfacePoint& to);
// offset_origin() of each.
Lanes3 offset_origins(const Points4& points, const Lanes3& direction);
// ray_between() of each, for ends that lie off their surfaces. direction: unit, from start towards end.
Rays4 rays_between(const Lanes3& start, const Lanes3& end, const Lanes3& direction, float time);

}  // namespace gradus::geometry
