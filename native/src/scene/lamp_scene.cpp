#include "scene/lamp_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>

#include "base/error.h"

namespace gradus {

namespace {

constexpr size_t kMaxListed = 12;

// Equal distances by index, so that the order does not depend on the traversal.
bool before(const LampHit& a, const LampHit& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.point.index < b.point.index;
}

void try_lamp(const std::vector<Lamp>& lamps, uint32_t index, const Ray& ray, std::vector<LampHit>* hits) {
  LampHit hit{};
  if (!intersect_lamp(lamps[index], ray, &hit.point, &hit.distance)) return;
  hit.point.index = index;
  hits->push_back(hit);
}

struct Query {
  RTCIntersectContext context;  // first: Embree hands out its address
  const std::vector<Lamp>* lamps;
  const std::vector<uint32_t>* placed;
  const Ray* ray;
  std::vector<LampHit>* hits;
};

struct Placed {
  const std::vector<Lamp>* lamps;
  const std::vector<uint32_t>* indices;
};

void bound_lamp(const RTCBoundsFunctionArguments* args) {
  const auto* placed = static_cast<const Placed*>(args->geometryUserPtr);
  const LightBounds b = lamp_bounds((*placed->lamps)[(*placed->indices)[args->primID]]);
  const Vec3 pad = 1e-5f * (glm::abs(b.lower) + glm::abs(b.upper)) + 1e-6f * (b.upper - b.lower);
  const Vec3 lower = b.lower - pad, upper = b.upper + pad;
  *args->bounds_o = {lower.x, lower.y, lower.z, 0.0f, upper.x, upper.y, upper.z, 0.0f};
}

// Collects, and never reports a hit to Embree: the ray goes on to the end.
void meet_lamp(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  auto* query = reinterpret_cast<Query*>(args->context);
  try_lamp(*query->lamps, (*query->placed)[args->primID], *query->ray, query->hits);
}

}  // namespace

LampScene::LampScene(const EmbreeDevice& device, const std::vector<Lamp>& lamps) : device_(device) {
  for (uint32_t i = 0; i < lamps.size(); ++i)
    if (lamps[i].found_by_rays()) (lamps[i].at_infinity() ? listed_ : placed_).push_back(i);
  if (placed_.size() <= kMaxListed) {
    listed_.insert(listed_.end(), placed_.begin(), placed_.end());
    placed_.clear();
    return;
  }
  Placed placed{&lamps, &placed_};
  scene_ = rtcNewScene(device.get());
  const RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(placed_.size()));
  rtcSetGeometryUserData(geometry, &placed);
  rtcSetGeometryBoundsFunction(geometry, bound_lamp, nullptr);
  rtcSetGeometryIntersectFunction(geometry, meet_lamp);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
    rtcReleaseScene(scene_);
    throw Error(GRADUS_ERROR_UNKNOWN, "Embree failed to build the lamps");
  }
}

LampScene::~LampScene() {
  if (scene_) rtcReleaseScene(scene_);
}

void LampScene::intersect(const std::vector<Lamp>& lamps, const Ray& ray, std::vector<LampHit>* hits) const {
  if (!is_finite(ray.origin) || !is_finite(ray.direction) || !(ray.t_min < ray.t_max)) return;
  for (const uint32_t i : listed_) try_lamp(lamps, i, ray, hits);
  if (scene_) trace_placed(lamps, ray, hits);
  if (hits->size() > 1) std::sort(hits->begin(), hits->end(), before);
}

void LampScene::trace_placed(const std::vector<Lamp>& lamps, const Ray& ray, std::vector<LampHit>* hits) const {
  Query query{{}, &lamps, &placed_, &ray, hits};
  rtcInitIntersectContext(&query.context);
  RTCRayHit r{};
  r.ray.org_x = ray.origin.x, r.ray.org_y = ray.origin.y, r.ray.org_z = ray.origin.z;
  r.ray.dir_x = ray.direction.x, r.ray.dir_y = ray.direction.y, r.ray.dir_z = ray.direction.z;
  r.ray.tnear = std::max(ray.t_min, 0.0f);
  r.ray.tfar = ray.t_max;
  r.ray.mask = 0xffffffffu;
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &query.context, &r);
}

}  // namespace gradus
