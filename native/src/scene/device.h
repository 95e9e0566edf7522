// Resources that all renders of one host share: threads, the Embree device, colour management and warnings.
#pragma once

#include <memory>
#include <string>

#include <tbb/task_arena.h>

#include "base/warnings.h"
#include "geometry/embree_device.h"
#include "gradus/gradus.h"

namespace gradus::image {
class ColorManager;  // image/color.h
}  // namespace gradus::image

namespace gradus::scene {

class Device {
 public:
  // Throws Error UNSUPPORTED if Embree or TBB are not those that Gradus was built with.
  explicit Device(const GradusDeviceSettings& settings);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const geometry::EmbreeDevice& embree() const { return embree_; }
  // Tasks in the arena flush denormals. Threads of Gradus that compute outside of it do so by FlushDenormals
  // (base/fpu.h).
  tbb::task_arena& arena() { return arena_; }
  uint32_t threads() const { return threads_; }
  image::ColorManager& color() { return *color_; }
  const std::string& denoiser_path() const { return denoiser_path_; }
  // Warnings of colour management. Warnings of a scene are in its snapshot.
  Warnings& warnings() { return warnings_; }

 private:
  Warnings warnings_;
  geometry::EmbreeDevice embree_;
  uint32_t threads_ = 0;
  tbb::task_arena arena_;
  std::unique_ptr<image::ColorManager> color_;
  const std::string denoiser_path_;
};

}  // namespace gradus::scene
