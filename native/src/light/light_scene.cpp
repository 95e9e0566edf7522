#include "light/light_scene.h"

#include <algorithm>

#include <embree3/rtcore.h>

#include "base/error.h"

namespace gradus::light {

namespace {

// Maximum number of finite lights that are tested one by one, without an Embree scene.
constexpr size_t kMaxListed = 12;

// Orders hits by distance. Hits of equal distance are ordered by index, so that the result does not depend on
// traversal.
bool before(const LightHit& a, const LightHit& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.point.index < b.point.index;
}

// Appends the intersection of a ray with one light, if there is one.
void try_light(const std::vector<AnalyticLight>& analytic_lights, uint32_t index, const Ray& ray,
               std::vector<LightHit>* hits) {
  LightHit hit{};
  if (!intersect_light(analytic_lights[index], ray, &hit.point, &hit.distance)) return;
  hit.point.index = index;
  hits->push_back(hit);
}

struct Query {
  RTCIntersectContext context;  // Must be first: Embree passes its address to meet_light().
  const std::vector<AnalyticLight>* analytic_lights;
  const std::vector<uint32_t>* placed;
  const Ray* ray;
  std::vector<LightHit>* hits;
};

struct Placed {
  const std::vector<AnalyticLight>* analytic_lights;
  const std::vector<uint32_t>* indices;
};

void bound_light(const RTCBoundsFunctionArguments* args) {
  const auto* placed = static_cast<const Placed*>(args->geometryUserPtr);
  const LightBounds b = light_bounds((*placed->analytic_lights)[(*placed->indices)[args->primID]]);
  const Vec3 pad = 1e-5f * (glm::abs(b.lower) + glm::abs(b.upper)) + 1e-6f * (b.upper - b.lower);
  const Vec3 lower = b.lower - pad, upper = b.upper + pad;
  *args->bounds_o = {lower.x, lower.y, lower.z, 0.0f, upper.x, upper.y, upper.z, 0.0f};
}

// Embree's intersection callback. It collects the hit but does not report it to Embree, so that traversal continues.
void meet_light(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  auto* query = reinterpret_cast<Query*>(args->context);
  try_light(*query->analytic_lights, (*query->placed)[args->primID], *query->ray, query->hits);
}

}  // namespace

LightScene::LightScene(const geometry::EmbreeDevice& device, const std::vector<AnalyticLight>& analytic_lights)
    : device_(device) {
  for (uint32_t i = 0; i < analytic_lights.size(); ++i)
    if (analytic_lights[i].found_by_rays()) (analytic_lights[i].at_infinity() ? listed_ : placed_).push_back(i);
  if (placed_.size() <= kMaxListed) {
    listed_.insert(listed_.end(), placed_.begin(), placed_.end());
    placed_.clear();
    return;
  }
  Placed placed{&analytic_lights, &placed_};
  scene_ = rtcNewScene(device.get());
  const RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(placed_.size()));
  rtcSetGeometryUserData(geometry, &placed);
  rtcSetGeometryBoundsFunction(geometry, bound_light, nullptr);
  rtcSetGeometryIntersectFunction(geometry, meet_light);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
    rtcReleaseScene(scene_);
    throw Error(GRADUS_ERROR_UNKNOWN, "Embree failed to build the scene of analytic lights");
  }
}

LightScene::~LightScene() {
  if (scene_) rtcReleaseScene(scene_);
}

void LightScene::intersect(const std::vector<AnalyticLight>& analytic_lights, const Ray& ray,
                           std::vector<LightHit>* hits) const {
  if (!is_finite(ray.origin) || !is_finite(ray.direction) || !(ray.t_min < ray.t_max)) return;
  for (const uint32_t i : listed_) try_light(analytic_lights, i, ray, hits);
  if (scene_) trace_placed(analytic_lights, ray, hits);
  if (hits->size() > 1) std::sort(hits->begin(), hits->end(), before);
}

void LightScene::trace_placed(const std::vector<AnalyticLight>& analytic_lights, const Ray& ray,
                              std::vector<LightHit>* hits) const {
  Query query{{}, &analytic_lights, &placed_, &ray, hits};
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

}  // namespace gradus::light
