#include "scene/device.h"

#include <algorithm>

#include <tbb/info.h>
#include <tbb/version.h>

#include "base/error.h"
#include "base/fpu.h"
#include "base/threads.h"
#include "image/color.h"

namespace gradus::scene {

namespace {

void check_tbb() {
  if (TBB_runtime_interface_version() < TBB_INTERFACE_VERSION)
    throw unsupported("the TBB in this process is older than the one that Gradus was built with");
}

uint32_t thread_count(uint32_t wanted) {
  constexpr uint32_t kMaxThreads = 1024;
  const auto all = uint32_t(std::max(1, tbb::info::default_concurrency()));
  return std::min(wanted == 0 ? all : wanted, kMaxThreads);
}

}  // namespace

Device::Device(const GradusDeviceSettings& settings)
    : threads_(thread_count(settings.threads)), denoiser_path_(settings.denoiser_path ? settings.denoiser_path : "") {
  check_tbb();
  color_ = std::make_unique<image::ColorManager>(settings.color_config ? settings.color_config : "",
                                                 [this](const std::string& text) { warnings_.add(text); });
  embree_ = geometry::make_embree_device(threads_);
  // TBB gives all tasks of an arena the floating-point state of the thread that initialised it.
  const FlushDenormals flush;
  arena_.initialize(int(threads_), 1);
}

Device::~Device() = default;

}  // namespace gradus::scene
