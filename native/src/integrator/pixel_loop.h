// From units of work to samples of pixels; the same for all camera-path integrators.
#pragma once

#include "frame/gate.h"
#include "integrator/integrator.h"
#include "path/trace.h"

namespace gradus {

struct PixelSample {
  int32_t x = 0, y = 0;
  size_t pixel = 0;     // in the frame's planes
  uint32_t number = 0;  // sample number
  int half = 0;         // even numbers A, odd ones B (contract 1.2)
  Sampler sampler;
  Vec2 film = Vec2(0.0f);
};

// Samples that a unit takes of a pixel.
inline uint32_t unit_count(const WorkUnit& unit, size_t pixel) { return unit.count_map != nullptr ? (*unit.count_map)[pixel] : unit.count; }

// Those of them that belong to a half.
inline uint32_t half_count(const WorkUnit& unit, size_t pixel, int half) {
  const uint32_t count = unit_count(unit, pixel);
  const bool first_is_even = unit.first_sample % 2 == 0;
  return first_is_even == (half == 0) ? (count + 1) / 2 : count / 2;
}

PixelSample make_pixel_sample(const PathContext& context, const Frame& frame, int32_t x, int32_t y, uint32_t number);

// Calls body(PixelSample) for each sample of the unit, pixel by pixel, in order of their numbers, until `stop`. Sums thus do not depend on
// tiles, threads, or how samples were split over units.
template <class Body>
void for_each_sample(const PathContext& context, const WorkUnit& unit, const Frame& frame, const std::atomic<bool>& stop, Body&& body) {
  for (int32_t y = unit.tile.y0; y < unit.tile.y1; ++y) {
    for (int32_t x = unit.tile.x0; x < unit.tile.x1; ++x) {
      const uint32_t count = unit_count(unit, frame.index(x, y));
      for (uint32_t i = 0; i < count; ++i) {
        if (stop.load(std::memory_order_relaxed)) {
          return;
        }
        body(make_pixel_sample(context, frame, x, y, unit.first_sample + i));
      }
    }
  }
}

// The primal sample of a pixel goes through the gate.
void add_primal(const PathResult& result, const PixelSample& sample, Frame* frame, Counters* counters);

}  // namespace gradus
