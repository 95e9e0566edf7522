#include "geometry/embree_device.h"

#include <algorithm>
#include <limits>
#include <string>

#include <embree3/rtcore.h>

#include "base/error.h"

namespace gradus::geometry {

namespace {

// Checks version and features of the loaded Embree. Blender contains an Embree of its own, and the dynamic linker may
// bind our calls to it. Such a library reports another version, or lacks the features that Gradus needs.
void check_embree(RTCDevice device) {
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  if (version != RTC_VERSION)
    throw unsupported("the Embree in this process has version " + std::to_string(version) + " instead of " +
                      std::to_string(RTC_VERSION));
  if (!rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) ||
      !rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_USER_GEOMETRY_SUPPORTED))
    throw unsupported("the Embree in this process lacks ray masks or user geometry");
}

// Returns the error of a failed start: OUT_OF_MEMORY if Embree reports it, else UNSUPPORTED with the text `otherwise`.
// `device` is nullptr if it could not be created.
Error failure_of(RTCDevice device, const std::string& otherwise) {
  const bool no_memory = rtcGetDeviceError(device) == RTC_ERROR_OUT_OF_MEMORY;
  return no_memory ? Error(GRADUS_ERROR_OUT_OF_MEMORY, "out of memory while Embree starts") : unsupported(otherwise);
}

// Makes a scene of one triangle in the plane z = 2. The caller releases it.
RTCScene make_test_triangle(RTCDevice device) {
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 1));
  if (vertices && indices) {
    constexpr float kCorners[9] = {-1, -1, 2, 3, -1, 2, -1, 3, 2};
    std::copy(kCorners, kCorners + 9, vertices);
    for (unsigned i = 0; i < 3; ++i) indices[i] = i;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

// Returns whether a ray from the origin hits the test triangle at distance 2. With a wrong Embree it misses.
bool trace_test_ray(RTCDevice device) {
  const RTCScene scene = make_test_triangle(device);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray.dir_z = 1.0f;
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &query);
  rtcReleaseScene(scene);
  return query.hit.geomID != RTC_INVALID_GEOMETRY_ID && query.ray.tfar > 1.99f && query.ray.tfar < 2.01f;
}

}  // namespace

EmbreeDevice make_embree_device(uint32_t threads) {
  const std::string config = "threads=" + std::to_string(threads) + ",set_affinity=0,start_threads=0";
  EmbreeDevice device(rtcNewDevice(config.c_str()), [](RTCDevice d) {
    if (d) rtcReleaseDevice(d);
  });
  if (!device) throw failure_of(nullptr, "Embree cannot start on this processor (AVX2 is needed)");
  check_embree(device.get());
  if (!trace_test_ray(device.get()))
    throw failure_of(device.get(), "Embree's test ray missed: another Embree is loaded in this process");
  return device;
}

}  // namespace gradus::geometry
