// What renders of one host share: threads, Embree's device, colour management, warnings.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include <tbb/task_arena.h>

#include "gradus/gradus.h"

struct RTCDeviceTy;

namespace gradus {

class ColorManager;  // color/color.h

class Device {
 public:
  static constexpr size_t kMaxWarnings = 1000;

  // Throws Error UNSUPPORTED if Embree or TBB are not those it was built with (contract 7.5).
  explicit Device(const GradusDeviceSettings& settings);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  RTCDeviceTy* embree() const { return embree_; }
  // Tasks that run in it flush denormals; threads of our own that compute outside of it take FlushDenormals (base/fpu.h).
  tbb::task_arena& arena() { return arena_; }
  uint32_t threads() const { return threads_; }
  ColorManager& color() { return *color_; }
  // Each text is kept once; at most kMaxWarnings in all.
  void warn(const std::string& text);
  bool take_warning(std::string* text);

 private:
  RTCDeviceTy* embree_ = nullptr;
  uint32_t threads_ = 0;
  tbb::task_arena arena_;
  std::unique_ptr<ColorManager> color_;
  std::mutex mutex_;
  std::deque<std::string> warnings_;
  std::deque<std::string> seen_;
};

}  // namespace gradus
