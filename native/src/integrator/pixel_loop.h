// Loop over the samples of a work unit, shared by all integrators that start paths at the camera.
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
  size_t pixel = 0;     // index in the film's planes
  uint32_t number = 0;  // sample number
  int half = 0;         // half-buffer: 0 (A) for even numbers, 1 (B) for odd ones
  path::Sampler sampler;
  Vec2 film = Vec2(0.0f);  // position on the film, pixel filter included
  // Vertex that the camera ray meets; null if the pixel does not share its jitter with its neighbours.
  path::CameraVertex* first = nullptr;
};

// Returns the number of samples that a unit takes of a pixel.
inline uint32_t unit_count(const WorkUnit& unit, size_t pixel) {
  return unit.count_map != nullptr ? (*unit.count_map)[pixel] : unit.count;
}

// Returns whether the samples of a pixel take further camera rays.
inline bool unit_has_edge(const WorkUnit& unit, size_t pixel) {
  return unit.edge_map != nullptr && (*unit.edge_map)[pixel] != 0;
}

// Returns the components that a unit samples in a pixel, as bits.
inline uint32_t unit_components(const WorkUnit& unit, size_t pixel) {
  return unit.component_map != nullptr ? unit.components & (*unit.component_map)[pixel] : unit.components;
}

// Returns the first sample number of a pixel.
inline uint32_t unit_first(const WorkUnit& unit, size_t pixel) {
  return unit.first_map != nullptr ? (*unit.first_map)[pixel] : unit.first_sample;
}

// Returns the number of samples of a pixel that belong to one half-buffer.
inline uint32_t half_count(const WorkUnit& unit, size_t pixel, int half) {
  const uint32_t count = unit_count(unit, pixel);
  const bool first_is_even = unit_first(unit, pixel) % 2 == 0;
  return first_is_even == (half == 0) ? (count + 1) / 2 : count / 2;
}

// Returns the maximum number of samples that the unit takes of a pixel of the pixel block.
uint32_t max_samples(const WorkUnit& unit, const film::Film& film, const Region& block);
// Returns whether the pixels of a pixel block share their jitter, for the sake of offset paths. They do not without
// gradients, or if points on the lens or times separate the rays of neighbours anyway.
inline bool shares_jitter(const camera::Camera& camera, const scene::Snapshot& scene, bool gradients) {
  return gradients && !camera.has_lens() && !scene.features.has_motion;
}
// Returns whether all pixels of a pixel block use their own random numbers, or those of the same pixels of another
// frame, and share their jitter. Then the camera rays of base paths serve the offset paths of neighbours, too.
bool shares_rays(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, const Region& block);
// Returns the film offset of a sample number from the pixel centres of such a block.
Vec2 block_jitter(const path::PathContext& context, const WorkUnit& unit, const Region& block, uint32_t number);
// Returns the film offset of one pixel. If it replays a pixel whose block shared its jitter, it is that of the block.
Vec2 pixel_jitter(const path::PathContext& context, const WorkUnit& unit, const film::Film& film,
                  const PixelSample& sample);
// Returns a sample of a pixel without its film position and camera vertex.
PixelSample make_pixel_sample(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, int32_t x,
                              int32_t y, uint32_t number);

// Calls body(PixelSample) for each sample of the unit, until `stop`. The order is by pixel block, by sample number, and
// by pixel. So the sums of pixels do not depend on tiles, threads, or how samples are split over units. `vertices` may
// be null. Those of a row last until the row after the next is visited.
template <class Body>
void for_each_sample(const path::PathContext& context, const WorkUnit& unit, const film::Film& film,
                     path::CameraVertices* vertices, const std::atomic<bool>& stop, Body&& body) {
  for (const Region& block : film::make_pixel_blocks(unit.tile)) {
    const bool is_shared = shares_rays(context, unit, film, block);
    const uint32_t maximum = max_samples(unit, film, block), first = unit_first(unit, film.index(block.x0, block.y0));
    for (uint32_t i = 0; i < maximum; ++i) {
      const uint32_t number = first + i;
      const Vec2 jitter = is_shared ? block_jitter(context, unit, block, number) : Vec2(0.0f);
      if (vertices != nullptr) vertices->begin(jitter);
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
          if (is_shared && vertices != nullptr) {
            sample.first = vertices->at(x, y);
          }
          sample.film = path::pixel_centre(x, y) + (is_shared ? jitter : pixel_jitter(context, unit, film, sample));
          body(sample);
        }
      }
    }
  }
}

// Adds a sample to the primal planes of its pixel through the finite check, and counts it.
void add_primal(const path::PathResult& result, const PixelSample& sample, const WorkUnit& unit, film::Film* film,
                film::Counters* counters);

}  // namespace gradus::integrator
