// Where the next samples go: cells of 16×16 that are good enough stop (contract 5.3), and the others share a batch by
// their noise.
#pragma once

#include <cstdint>
#include <vector>

#include "film/pixel_blocks.h"
#include "reconstruct/solver.h"
#include "render/block_noise.h"

namespace gradus::render {

// Of each pixel of the region: number of its next sample, and how many it takes (WorkUnit::first_map, count_map).
struct SampleMap {
  std::vector<uint32_t> first, count;
};

class AdaptiveSampling {
 public:
  // Goes on from `frame`, in which all pixels of a cell have the same number of samples. A cell may stop from
  // `first_check` samples on; once stopped it stays so.
  AdaptiveSampling(const film::Film& film, float threshold, uint32_t first_check);

  void judge(const std::vector<BlockNoise>& noise);
  // What the samples of a cell in a batch have cost: rays, which are the same whenever and wherever they are traced,
  // where times are not. Thread-safe for different cells.
  void add_rays(const Region& block, uint64_t rays) { rays_[index(block.x0, block.y0)] += rays; }
  const std::vector<Region>& blocks() const { return grid_.blocks; }
  bool all_done() const;

  // Begins a batch with `mean` samples per pixel of the cells that go on. Equal for all until judge() has told them
  // apart.
  void start_batch(uint32_t mean);
  const SampleMap& batch() const { return batch_; }
  // Samples of the pixels that have most.
  uint32_t max_taken() const;
  // What the next render needs to go on, after batches of `mean` samples altogether.
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
  uint32_t uncounted_ = 0;       // samples of each pixel whose rays are not known
  std::vector<uint32_t> taken_;  // samples of each cell's pixels
  std::vector<uint64_t> rays_;
  std::vector<double> spread_;  // relative deviation of one sample
  std::vector<uint8_t> stopped_;
  bool judged_ = false;
  SampleMap batch_;
};

}  // namespace gradus::render
