#include "base/device.h"

#include <algorithm>
#include <limits>

#include <embree3/rtcore.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/version.h>

#include "base/error.h"
#include "base/fpu.h"
#include "color/color.h"

namespace gradus {

namespace {

void check_tbb() {
  if (TBB_runtime_interface_version() < TBB_INTERFACE_VERSION)
    throw unsupported("the TBB in this process is older than the one that Gradus was built with");
}

// A foreign Embree that took over our symbols answers with another version, or its rays miss: Blender has one, too.
void check_embree(RTCDevice device) {
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  if (version != RTC_VERSION)
    throw unsupported("the Embree in this process has version " + std::to_string(version) + " in place of " + std::to_string(RTC_VERSION));
  if (!rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) ||
      !rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_USER_GEOMETRY_SUPPORTED))
    throw unsupported("the Embree in this process lacks ray masks or user geometry");
}

// Why Embree did not do what it must: it had no memory, or `otherwise`. device: nullptr if there is none.
Error failure_of(RTCDevice device, const std::string& otherwise) {
  const bool no_memory = rtcGetDeviceError(device) == RTC_ERROR_OUT_OF_MEMORY;
  return no_memory ? Error(GRADUS_ERROR_OUT_OF_MEMORY, "out of memory while Embree starts") : unsupported(otherwise);
}

RTCScene make_test_triangle(RTCDevice device) {
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices =
      static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3));
  auto* indices =
      static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 1));
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

// One ray that must hit a triangle at distance 2.
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

uint32_t thread_count(uint32_t wanted) {
  constexpr uint32_t kMaxThreads = 1024;
  const auto all = uint32_t(std::max(1, tbb::info::default_concurrency()));
  return std::min(wanted == 0 ? all : wanted, kMaxThreads);
}

}  // namespace

int arena_size(uint32_t threads) {
  const size_t most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return int(std::clamp<size_t>(threads, 1, std::max<size_t>(most, 1)));
}

Device::Device(const GradusDeviceSettings& settings)
    : threads_(thread_count(settings.threads)), denoiser_path_(settings.denoiser_path ? settings.denoiser_path : "") {
  check_tbb();
  color_ = std::make_unique<ColorManager>(settings.color_config ? settings.color_config : "",
                                          [this](const std::string& text) { warnings_.add(text); });
  embree_ = rtcNewDevice(("threads=" + std::to_string(threads_) + ",set_affinity=0,start_threads=0").c_str());
  if (!embree_) throw failure_of(nullptr, "Embree cannot start on this processor (AVX2 is needed)");
  try {
    check_embree(embree_);
    if (!trace_test_ray(embree_)) throw failure_of(embree_, "Embree's test ray missed: another Embree in this process has taken its place");
    // TBB gives all tasks of an arena the floating-point state of the thread that initialised it.
    const FlushDenormals flush;
    arena_.initialize(int(threads_), 1);
  } catch (...) {
    rtcReleaseDevice(embree_);
    throw;
  }
}

Device::~Device() { rtcReleaseDevice(embree_); }

}  // namespace gradus
