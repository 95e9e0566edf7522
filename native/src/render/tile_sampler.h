// Takes the samples of a batch, tile by tile on all threads. A batch may be long: it can pause between tiles, and no
// thread writes to the film then.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <vector>

#include "integrator/integrator.h"
#include "render/adaptive_sampling.h"
#include "render/loop_input.h"
#include "render/pilot.h"

namespace gradus::render {

class TileSampler {
 public:
  // All arguments must outlive the object. `adaptive` is nullptr if all pixels take the same number of samples.
  // `replay` is nullptr if the samples are fresh ones of the frame.
  TileSampler(const integrator::Integrator& integrator, std::vector<Region> tiles, const GradientMap& gradients,
              const std::vector<uint8_t>& edges, AdaptiveSampling* adaptive, const Replay* replay,
              const std::atomic<bool>& stop, film::Film* film);

  // Starts the batch of samples [begin, end) of each pixel; in adaptive renders `end - begin` samples on average.
  void start_batch(uint32_t begin, uint32_t end);
  // Starts a batch of counts[pixel] samples of each pixel, which begin with the sample number `first`, whatever the
  // first sample of the render. `counts` must outlive it.
  void start_counted_batch(uint32_t first, const std::vector<uint32_t>* counts);
  // Called after each tile, on the thread that sampled it. Returns true to pause.
  using AfterTile = std::function<bool(const Region& tile, uint64_t pixel_samples)>;
  // Continues the batch in the caller's task arena. Returns false if it is not complete, because it paused or was
  // stopped.
  bool run(const AfterTile& after_tile);

  double cpu_seconds() const { return 1e-9 * double(cpu_.load()); }

 private:
  bool sample_tile(size_t tile, const AfterTile& after_tile);
  film::Counters sample_blocks(integrator::WorkUnit unit);
  film::Counters sample_replay(integrator::WorkUnit unit);
  film::Counters sample(const integrator::WorkUnit& unit);

  const integrator::Integrator& integrator_;
  const std::vector<Region> tiles_;
  const GradientMap& gradients_;
  const std::vector<uint8_t>& edges_;
  AdaptiveSampling* const adaptive_;
  const Replay* const replay_;
  const std::atomic<bool>& stop_;
  film::Film* const film_;
  const uint32_t first_sample_;

  uint32_t begin_ = 0, end_ = 0;
  const std::vector<uint32_t>* counts_ = nullptr;  // samples of each pixel in place of end_ − begin_
  std::vector<uint8_t> done_;                      // by tile: 1 if the batch has its samples
  std::atomic<uint64_t> cpu_{0};
  std::mutex counters_mutex_;
};

}  // namespace gradus::render
