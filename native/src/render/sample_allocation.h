// Distributes the samples of a batch over the pixel blocks of an image.
#pragma once

#include <cstdint>
#include <vector>

namespace gradus::render {

struct BlockShare {
  int64_t pixels = 0;
  uint32_t taken = 0;  // samples of each of its pixels so far
  // Relative standard deviation of one sample over the root of its cost. Not finite: counts as the maximum of all.
  double spread = 0.0;
  bool continues = true;  // false: the block takes no samples
};

// Minimum and maximum number of samples of a block, as shares of the mean. A few samples may miss rare light, and a
// wrong estimate must not cost more than half of the samples. Measured: 1/2 to 2 and 1/4 to 8 give the same error
// within 1 %.
inline constexpr double kMinShare = 0.5, kMaxShare = 4.0;

// Returns the number of samples for each pixel of each block, `mean` on average over the pixels of the blocks that
// continue. The mean squared error Σ s²/n over blocks is minimal at a given cost Σ c·n if n is proportional to s/√c
// (Neyman 1934; with costs Cochran 1977, section 5.5), so the total number of samples, earlier ones included,
// approaches this as far as it still can. Counts are even from mean 4 on, so that both half-buffers get equally many.
// None is 0, so that pairs of pixels across blocks have samples at both ends.
std::vector<uint32_t> allocate_samples(const std::vector<BlockShare>& blocks, uint32_t mean);

}  // namespace gradus::render
