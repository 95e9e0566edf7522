// Ray queries of a snapshot. Rays that are not finite miss and are never passed to Embree: its internal assertions
// abort on them, and NaN makes its traversal slow.
#include <algorithm>
#include <cstring>

#include <embree3/rtcore.h>

#include "geometry/accelerator.h"
#include "geometry/geometry.h"
#include "geometry/rays4.h"

namespace gradus::geometry {

namespace {

// Returns whether a ray is finite and its segment is not empty. The comparisons are false for NaN.
bool traceable(const Ray& ray) {
  const float sum =
      ray.direction.x * ray.direction.x + ray.direction.y * ray.direction.y + ray.direction.z * ray.direction.z;
  return is_finite(ray.origin) && sum > 0.0f && is_finite(sum) && ray.t_min < kInfinity && ray.t_min <= ray.t_max;
}

void set_ray(const Ray& ray, uint32_t mask, RTCRay* r) {
  r->org_x = ray.origin.x;
  r->org_y = ray.origin.y;
  r->org_z = ray.origin.z;
  r->tnear = ray.t_min < 0.0f ? 0.0f : ray.t_min;
  r->dir_x = ray.direction.x;
  r->dir_y = ray.direction.y;
  r->dir_z = ray.direction.z;
  r->time = ray.time;
  r->tfar = ray.t_max;
  r->mask = mask;
  r->id = 0;
  r->flags = 0;
}

using LaneBits = int32_t __attribute__((vector_size(16)));

// Copies four values to a field of an Embree ray packet.
template <class Field, class Values>
void set(Field* lanes, const Values& values) {
  std::memcpy(lanes, &values, sizeof(values));
}

template <class Packet>
void set_lane(const Ray& ray, uint32_t mask, int i, Packet* r) {
  r->org_x[i] = ray.origin.x;
  r->org_y[i] = ray.origin.y;
  r->org_z[i] = ray.origin.z;
  r->tnear[i] = ray.t_min < 0.0f ? 0.0f : ray.t_min;
  r->dir_x[i] = ray.direction.x;
  r->dir_y[i] = ray.direction.y;
  r->dir_z[i] = ray.direction.z;
  r->time[i] = ray.time;
  r->tfar[i] = ray.t_max;
  r->mask[i] = mask;
  r->id[i] = 0;
  r->flags[i] = 0;
}

// Returns the snapshot's index of the instance that was hit. The geometry id of a triangle in the top level is the
// index of the group's member. For an instanced mesh the instance id is that index, and the geometry id is 0.
uint32_t instance_of(const Accelerator::Part& part, unsigned instance_id, unsigned geometry_id) {
  return part.instances[instance_id != RTC_INVALID_GEOMETRY_ID ? instance_id : geometry_id];
}

// Returns whether a ray may hit something in the moving group.
bool may_meet_moving(const Accelerator& accelerator, const RTCRay& r) {
  return accelerator.moving.group && accelerator.moving.group->box.may_meet(
                                         {r.org_x, r.org_y, r.org_z}, {r.dir_x, r.dir_y, r.dir_z}, r.tnear, r.tfar);
}

// Returns whether a ray hits an instance that shares a bit with `mask`.
bool blocked_by(const Accelerator& accelerator, const Ray& ray, uint32_t mask) {
  if (!traceable(ray)) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay r;
  set_ray(ray, mask, &r);
  rtcOccluded1(accelerator.static_part.group->scene, &context, &r);
  if (r.tfar >= 0.0f && may_meet_moving(accelerator, r)) rtcOccluded1(accelerator.moving.group->scene, &context, &r);
  return r.tfar < 0.0f;
}

// Clears the valid lanes whose rays certainly miss the moving group. Returns whether any valid lane is left. Embree
// sets the end of an occluded ray to minus infinity, so that its lane is cleared too.
bool mask_lanes_that_meet_moving(const Accelerator& accelerator, const RTCRay4& r, int valid[4]) {
  if (!accelerator.moving.group) return false;
  const RayBox& box = accelerator.moving.group->box;
  bool any = false;
  for (int i = 0; i < 4; ++i) {
    if (valid[i] && !box.may_meet({r.org_x[i], r.org_y[i], r.org_z[i]}, {r.dir_x[i], r.dir_y[i], r.dir_z[i]},
                                  r.tnear[i], r.tfar[i]))
      valid[i] = 0;
    any |= valid[i] != 0;
  }
  return any;
}

// Context of a query for one instance of a group. Embree passes the first member to its filter function.
struct InstanceContext {
  RTCIntersectContext context;
  const Accelerator::Part* part;
  uint32_t instance;
};

// Embree's filter function of queries for one instance: rejects the hits of others.
void reject_others(const RTCFilterFunctionNArguments* args) {
  const auto& wanted = *reinterpret_cast<const InstanceContext*>(args->context);
  const unsigned instance_id = RTCHitN_instID(args->hit, args->N, 0, 0);
  if (instance_of(*wanted.part, instance_id, RTCHitN_geomID(args->hit, args->N, 0)) != wanted.instance)
    args->valid[0] = 0;
}

// Context of a query for the blockers of a light.
struct BlockerContext {
  RTCIntersectContext context;
  const Accelerator::Part* part;
  const std::vector<InstanceData>* instances;
  uint64_t blockers;
};

// Embree's filter function of queries for blockers: rejects the hits of other instances.
void reject_others_than_blockers(const RTCFilterFunctionNArguments* args) {
  const auto& wanted = *reinterpret_cast<const BlockerContext*>(args->context);
  const unsigned instance_id = RTCHitN_instID(args->hit, args->N, 0, 0);
  const uint32_t instance = instance_of(*wanted.part, instance_id, RTCHitN_geomID(args->hit, args->N, 0));
  if (((*wanted.instances)[instance].shadow_set & wanted.blockers) == 0) args->valid[0] = 0;
}

// Finds a hit in one group that is nearer than the query's current hit. Returns false if there is none; the query's
// distance is unchanged then.
bool intersect(const Accelerator::Part& part, RTCIntersectContext* context, RTCRayHit* query) {
  query->hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(part.group->scene, context, query);
  return query->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

// Finds the nearest hit in both groups. `context_of` returns the context for a group.
template <class ContextOf>
bool nearest(const Accelerator& accelerator, const Ray& ray, uint32_t mask, ContextOf&& context_of, Hit* hit) {
  *hit = Hit();
  if (!traceable(ray)) return false;
  RTCRayHit query;
  set_ray(ray, mask, &query.ray);
  const auto take = [&](const Accelerator::Part& part) {
    if (!intersect(part, context_of(part), &query)) return;
    hit->t = query.ray.tfar;
    hit->instance = instance_of(part, query.hit.instID[0], query.hit.geomID);
    hit->primitive = query.hit.primID;
    hit->uv = Vec2(query.hit.u, query.hit.v);
    hit->time = ray.time;
  };
  take(accelerator.static_part);
  if (may_meet_moving(accelerator, query.ray)) take(accelerator.moving);
  return hit->valid();
}

}  // namespace

bool trace_nearest(const Accelerator& accelerator, const Ray& ray, uint32_t mask, Hit* hit) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return nearest(
      accelerator, ray, mask, [&](const Accelerator::Part&) { return &context; }, hit);
}

bool trace_instance(const Accelerator& accelerator, const Ray& ray, uint32_t instance, Hit* hit) {
  InstanceContext wanted;
  rtcInitIntersectContext(&wanted.context);
  wanted.context.filter = reject_others;
  wanted.instance = instance;
  const auto context_of = [&](const Accelerator::Part& part) {
    wanted.part = &part;
    return &wanted.context;
  };
  return nearest(accelerator, ray, UINT32_MAX, context_of, hit);
}

bool trace_any(const Accelerator& accelerator, const Ray& ray, uint32_t mask) {
  return blocked_by(accelerator, ray, mask);
}

bool Geometry::intersect(const Ray& ray, uint32_t visibility, Hit* hit) const {
  return trace_nearest(*accelerator, ray, visibility & kMaskVisibility, hit);
}

bool Geometry::intersect_instance(const Ray& ray, uint32_t instance, Hit* hit) const {
  return trace_instance(*accelerator, ray, instance, hit);
}

bool Geometry::intersect_blocker(const Ray& ray, uint32_t mask, uint64_t blockers, Hit* hit) const {
  BlockerContext wanted;
  rtcInitIntersectContext(&wanted.context);
  wanted.context.filter = reject_others_than_blockers;
  wanted.instances = &instances;
  wanted.blockers = blockers;
  const auto context_of = [&](const Accelerator::Part& part) {
    wanted.part = &part;
    return &wanted.context;
  };
  return nearest(*accelerator, ray, mask, context_of, hit);
}

bool Geometry::occluded(const Ray& ray) const { return blocked_by(*accelerator, ray, GRADUS_VISIBLE_SHADOW); }

bool Geometry::meets(const Ray& ray, uint32_t visibility) const {
  return blocked_by(*accelerator, ray, visibility & kMaskVisibility);
}

void Geometry::intersect4(const Ray rays[4], uint32_t visibility, Hit hits[4]) const {
  alignas(16) int valid[4];
  RTCRayHit4 query;
  for (int i = 0; i < 4; ++i) {
    hits[i] = Hit();
    const bool trace = traceable(rays[i]);
    valid[i] = trace ? -1 : 0;
    set_lane(trace ? rays[i] : Ray{Vec3(0.0f), 0.0f, Vec3(0, 0, 1), -1.0f}, visibility & kMaskVisibility, i,
             &query.ray);
  }
  const auto take = [&](const Accelerator::Part& part) {
    std::fill_n(query.hit.geomID, 4, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(query.hit.instID[0], 4, RTC_INVALID_GEOMETRY_ID);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect4(valid, part.group->scene, &context, &query);
    for (int i = 0; i < 4; ++i) {
      if (!valid[i] || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hits[i].t = query.ray.tfar[i];
      hits[i].instance = instance_of(part, query.hit.instID[0][i], query.hit.geomID[i]);
      hits[i].primitive = query.hit.primID[i];
      hits[i].uv = Vec2(query.hit.u[i], query.hit.v[i]);
      hits[i].time = rays[i].time;
    }
  };
  take(accelerator->static_part);
  if (mask_lanes_that_meet_moving(*accelerator, query.ray, valid)) take(accelerator->moving);
}

void Geometry::occluded4(const Rays4& rays, const bool wanted[4], bool blocked[4]) const {
  const Lanes3 &o = rays.origin, &d = rays.direction;
  const Lanes length2 = d.x * d.x + d.y * d.y + d.z * d.z;
  const Lanes sum = o.x + o.y + o.z + length2;
  const LaneBits want{-int(wanted[0]), -int(wanted[1]), -int(wanted[2]), -int(wanted[3])};
  const LaneBits valid = want & (sum - sum == 0.0f) & (length2 > 0.0f) & (rays.t_max >= 0.0f);
  const Lanes zero{};
  RTCRay4 query;
  set(query.org_x, o.x);
  set(query.org_y, o.y);
  set(query.org_z, o.z);
  set(query.tnear, zero);
  set(query.dir_x, d.x);
  set(query.dir_y, d.y);
  set(query.dir_z, d.z);
  set(query.time, same(rays.time));
  set(query.tfar, rays.t_max);
  set(query.mask, LaneBits{} + int32_t(GRADUS_VISIBLE_SHADOW));
  set(query.id, zero);
  set(query.flags, zero);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  alignas(16) int lanes[4];
  std::memcpy(lanes, &valid, sizeof(lanes));
  rtcOccluded4(lanes, accelerator->static_part.group->scene, &context, &query);
  if (mask_lanes_that_meet_moving(*accelerator, query, lanes))
    rtcOccluded4(lanes, accelerator->moving.group->scene, &context, &query);
  for (int i = 0; i < 4; ++i) blocked[i] = valid[i] != 0 && query.tfar[i] < 0.0f;
}

}  // namespace gradus::geometry
