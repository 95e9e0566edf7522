// Progress of a render: a fraction in [0, 1] that never falls. Thread-safe.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace gradus::render {

class ProgressTracker {
 public:
  // Share of sampling in the progress; the rest is reconstruction.
  static constexpr float kSamplingShare = 0.95f;

  // Sets the fraction if it is larger than the present one.
  void raise_to(float fraction) {
    fraction = std::clamp(fraction, 0.0f, 1.0f);
    float now = fraction_.load(std::memory_order_relaxed);
    while (now < fraction && !fraction_.compare_exchange_weak(now, fraction, std::memory_order_relaxed)) {
    }
  }
  float fraction() const { return fraction_.load(std::memory_order_relaxed); }

  void set_samples(uint32_t samples) { samples_.store(samples, std::memory_order_relaxed); }
  uint32_t samples() const { return samples_.load(std::memory_order_relaxed); }
  void new_image() { version_.fetch_add(1, std::memory_order_release); }
  uint32_t version() const { return version_.load(std::memory_order_acquire); }

 private:
  std::atomic<float> fraction_{0.0f};
  std::atomic<uint32_t> samples_{0};
  std::atomic<uint32_t> version_{0};
};

}  // namespace gradus::render
