// From units of work to samples of pixels; the same for all camera-path integrators.
#pragma once

#include "base/fault.h"
#include "film/finite_check.h"
#include "film/pixel_blocks.h"
#include "integrator/integrator.h"
#include "path/camera_vertices.h"
#include "path/trace.h"

namespace gradus::integrator {

struct PixelSample {
  int32_t x = 0, y = 0;
  size_t pixel = 0;     // in the frame's planes
  uint32_t number = 0;  // sample number
  int half = 0;         // even numbers A, odd ones B (contract 1.2)
  path::Sampler sampler;
  Vec2 film = Vec2(0.0f);
  path::CameraVertex* first =
      nullptr;  // what the camera ray meets; nullptr where lens or time set the rays of neighbours apart
};

// Samples that a unit takes of a pixel.
inline uint32_t unit_count(const WorkUnit& unit, size_t pixel) {
  return unit.count_map != nullptr ? (*unit.count_map)[pixel] : unit.count;
}

// Bits of the components of which they are.
inline uint32_t unit_components(const WorkUnit& unit, size_t pixel) {
  return unit.component_map != nullptr ? unit.components & (*unit.component_map)[pixel] : unit.components;
}

// Number of the first of them.
inline uint32_t unit_first(const WorkUnit& unit, size_t pixel) {
  return unit.first_map != nullptr ? (*unit.first_map)[pixel] : unit.first_sample;
}

// Those of them that belong to a half.
inline uint32_t half_count(const WorkUnit& unit, size_t pixel, int half) {
  const uint32_t count = unit_count(unit, pixel);
  const bool first_is_even = unit_first(unit, pixel) % 2 == 0;
  return first_is_even == (half == 0) ? (count + 1) / 2 : count / 2;
}

// Most samples that the unit takes of a pixel of the cell.
uint32_t max_samples(const WorkUnit& unit, const film::Film& film, const Region& block);
// Neither lens nor time set the rays of neighbours apart: the pixels of a cell share their jitter.
inline bool shares_jitter(const camera::Camera& camera, const scene::Snapshot& scene) {
  return !camera.has_lens() && !scene.features.has_motion;
}
// All pixels of a cell take their own random numbers, or those of the same pixels of another frame: what shares its
// jitter shares its rays.
bool shares_rays(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, const Region& block);
// Offset of such a cell's pixels from their centres, by the filter.
Vec2 block_jitter(const path::PathContext& context, const WorkUnit& unit, const Region& block, uint32_t number);
// That of a pixel by itself: where it replays one whose cell shared its jitter, that of the cell.
Vec2 pixel_jitter(const path::PathContext& context, const WorkUnit& unit, const film::Film& film,
                  const PixelSample& sample);
// All but its place on the film.
PixelSample make_pixel_sample(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, int32_t x,
                              int32_t y, uint32_t number);

// Calls body(PixelSample) for each sample of the unit, until `stop`: cell by cell, in order of sample numbers, over the
// cell's pixels. Sums of pixels thus do not depend on tiles, threads, or how samples were split over units.
template <class Body>
void for_each_sample(const path::PathContext& context, const WorkUnit& unit, const film::Film& film,
                     path::CameraVertices* vertices, const std::atomic<bool>& stop, Body&& body) {
  for (const Region& block : film::make_pixel_blocks(unit.tile)) {
    const bool together = shares_rays(context, unit, film, block);
    const uint32_t maximum = max_samples(unit, film, block), first = unit_first(unit, film.index(block.x0, block.y0));
    for (uint32_t i = 0; i < maximum; ++i) {
      const uint32_t number = first + i;
      const Vec2 jitter = together ? block_jitter(context, unit, block, number) : Vec2(0.0f);
      vertices->begin(jitter);
      for (int32_t y = block.y0; y < block.y1 - (GRADUS_FAULT(last_row_of_pixel_blocks_lost) ? 1 : 0); ++y) {
        for (int32_t x = block.x0; x < block.x1; ++x) {
          const size_t pixel = film.index(x, y);
          if (i >= unit_count(unit, pixel) || (unit.pixel_map != nullptr && (*unit.pixel_map)[pixel] == 0)) {
            continue;
          }
          if (stop.load(std::memory_order_relaxed) && !GRADUS_FAULT(cancel_missed_between_samples)) {
            return;
          }
          PixelSample sample = make_pixel_sample(context, unit, film, x, y, number);
          if (together) {
            sample.first = vertices->at(x, y);
          }
          sample.film = path::pixel_centre(x, y) + (together ? jitter : pixel_jitter(context, unit, film, sample));
          body(sample);
        }
      }
    }
  }
}

// The primal sample of a pixel goes through the gate.
void add_primal(const path::PathResult& result, const PixelSample& sample, const WorkUnit& unit, film::Film* film,
                film::Counters* counters);

}  // namespace gradus::integrator
