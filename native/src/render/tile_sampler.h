// Takes the samples of a batch, tile by tile on all threads. A batch may be long: it can pause between tiles, and the
// frame is at rest then.
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
  // What it is given lives as long as it. adaptive: nullptr where all pixels take the same samples. replay: nullptr
  // where they are the frame's own.
  TileSampler(const integrator::Integrator& integrator, std::vector<Region> tiles, const GradientMap& gradients,
              AdaptiveSampling* adaptive, const Replay* replay, const std::atomic<bool>& stop, film::Film* film);

  // Samples [begin, end) of each pixel; in adaptive renders that many on average, as the sharing of these says.
  void start_batch(uint32_t begin, uint32_t end);
  // Called for each tile when it has its samples, on the thread that took them. True: pause.
  using AfterTile = std::function<bool(const Region& tile, uint64_t pixel_samples)>;
  // Goes on with the batch, in the caller's arena. False: not all of it is done yet, for it has paused or was stopped.
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
  AdaptiveSampling* const adaptive_;
  const Replay* const replay_;
  const std::atomic<bool>& stop_;
  film::Film* const film_;
  const uint32_t first_sample_;

  uint32_t begin_ = 0, end_ = 0;
  std::vector<uint8_t> done_;  // of the batch, by tiles
  std::atomic<uint64_t> cpu_{0};
  std::mutex counters_mutex_;
};

}  // namespace gradus::render
