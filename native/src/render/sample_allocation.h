// How the samples of a batch are shared by the cells of a picture.
#pragma once

#include <cstdint>
#include <vector>

namespace gradus::render {

struct BlockShare {
  int64_t pixels = 0;
  uint32_t taken = 0;  // samples of each of its pixels so far
  double spread =
      0.0;  // relative deviation of one sample over the root of its cost; what is not finite counts as the largest
  bool continues = true;  // false: takes none
};

// A cell has between these shares of the mean number of samples: few samples do not see rare light, and a wrong
// estimate must not cost more than a half. Measured: 1/2 to 2 and 1/4 to 8 give the same error within 1 %.
inline constexpr double kMinShare = 0.5, kMaxShare = 4.0;

// Samples for each pixel of each cell, `mean` on average over the pixels of the cells that go on. Σ s²/n over cells,
// the mean squared error, is least at the same cost Σ c·n for n in proportion to s/√c (Neyman 1934; with costs Cochran
// 1977, section 5.5), so all samples together, those taken included, approach this as far as they still can. Counts are
// even from mean 4 on, so that halves stay alike, and none is 0: pairs across cells have samples at both ends.
std::vector<uint32_t> allocate_samples(const std::vector<BlockShare>& blocks, uint32_t mean);

}  // namespace gradus::render
