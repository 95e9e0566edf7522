// Adaptive sampling: pixel blocks of 16×16 stop when their estimated error is below the noise threshold, and the others
// share the samples of a batch by their noise.
#pragma once

#include <cstdint>
#include <vector>

#include "film/pixel_blocks.h"
#include "render/block_noise.h"

namespace gradus::render {

// For each pixel of the region: the number of its next sample, and how many samples it takes in the batch
// (WorkUnit::first_map, count_map).
struct SampleMap {
  std::vector<uint32_t> first, count;
};

class AdaptiveSampling {
 public:
  // Starts from the samples of `film`, in which all pixels of a block have the same number of samples. A block may stop
  // once it has `first_check` samples, and then stays stopped.
  AdaptiveSampling(const film::Film& film, float threshold, uint32_t first_check);

  // Takes the estimated noise of each block: stops the blocks whose relative error is below the threshold, and updates
  // the spreads by which the others share samples.
  void judge(const std::vector<BlockNoise>& noise);
  // Adds the cost of the samples of a block. The cost is counted in rays, because the number of rays is the same in
  // every run and CPU time is not. Thread-safe for different blocks.
  void add_rays(const Region& block, uint64_t rays) { rays_[index(block.x0, block.y0)] += rays; }
  const std::vector<Region>& blocks() const { return grid_.blocks; }
  bool all_done() const;

  // Begins a batch with `mean` samples per pixel on average over the blocks that have not stopped. All blocks get the
  // same number until the first call of judge().
  void start_batch(uint32_t mean);
  const SampleMap& batch() const { return batch_; }
  // Returns the maximum number of samples of any pixel.
  uint32_t max_taken() const;
  // Returns the state that a later render needs to continue, after batches with `mean` samples in total.
  film::AdaptiveState state(uint32_t mean) const { return {mean, uncounted_, rays_, stopped_}; }

 private:
  size_t index(int32_t x, int32_t y) const;
  double smooth_spread(size_t block) const;
  double rays_per_sample(size_t block) const;

  Region region_;
  uint32_t first_sample_;
  float threshold_;
  uint32_t first_check_;
  film::PixelBlockGrid grid_;
  uint32_t uncounted_ = 0;       // samples of each pixel whose rays were not counted
  std::vector<uint32_t> taken_;  // samples of each pixel, by block
  std::vector<uint64_t> rays_;
  std::vector<double> spread_;  // relative standard deviation of one sample, by block
  std::vector<uint8_t> stopped_;
  bool judged_ = false;
  SampleMap batch_;
};

}  // namespace gradus::render
