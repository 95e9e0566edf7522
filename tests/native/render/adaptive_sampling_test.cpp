// Distribution of the samples of a batch over pixel blocks.
#include "render/adaptive_sampling.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace gradus::adaptive_sampling_test {
namespace {

constexpr int kCells = 7, kMiddle = 3;
constexpr uint32_t kMean = 16;

// Sample counts of a row of blocks, of which the middle one is noisy, in the batch after the first.
class RowOfBlocks : public testing::Test {
 protected:
  RowOfBlocks()
      : film_(kCells * film::kPixelBlockSide, film::kPixelBlockSide,
              {0, 0, kCells * film::kPixelBlockSide, film::kPixelBlockSide}, 3, 1, false),
        sampling_(film_, 1e-6f, kMean) {}

  std::vector<uint32_t> counts() {
    sampling_.start_batch(kMean);
    std::vector<uint32_t> counts;
    for (int i = 0; i < kCells; ++i) counts.push_back(sampling_.batch().count[size_t(i) * film::kPixelBlockSide + 5]);
    return counts;
  }
  void judge(double middle, double others) {
    std::vector<render::BlockNoise> noise(kCells, {1.0, others});
    noise[kMiddle].spread = middle;
    sampling_.judge(noise);
  }

  film::Film film_;
  render::AdaptiveSampling sampling_;
};

// Nothing is known yet about the noise.
TEST_F(RowOfBlocks, TheFirstBatchIsUniform) { EXPECT_EQ(counts(), std::vector<uint32_t>(kCells, kMean)); }

// The noise is an estimate, and its cause may move to a neighbouring block in the next frame.
TEST_F(RowOfBlocks, NeighboursOfANoisyBlockTakeMoreThanThoseFurtherAway) {
  counts();
  judge(1.0, 0.1);
  const std::vector<uint32_t> found = counts();
  EXPECT_GT(found[kMiddle], found[kMiddle + 1]);
  EXPECT_GT(found[kMiddle + 1], found[kMiddle + 2] + 4);
  EXPECT_EQ(found[kMiddle + 1], found[kMiddle - 1]);
  EXPECT_EQ(found[kMiddle + 2], found[kMiddle + 3]);
}

}  // namespace
}  // namespace gradus::adaptive_sampling_test
