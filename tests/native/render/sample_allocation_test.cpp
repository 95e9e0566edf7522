// Distribution of samples by noise.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "render/sample_allocation.h"

namespace gradus::sample_allocation_test {
namespace {

constexpr int64_t kPixels = 256;

// Returns blocks with the same number of samples.
std::vector<render::BlockShare> blocks_with(const std::vector<double>& spreads, uint32_t taken) {
  std::vector<render::BlockShare> blocks;
  for (const double spread : spreads) blocks.push_back({kPixels, taken, spread, true});
  return blocks;
}

double given(const std::vector<render::BlockShare>& blocks, const std::vector<uint32_t>& counts) {
  double sum = 0.0;
  for (size_t i = 0; i < blocks.size(); ++i) sum += double(blocks[i].pixels) * counts[i];
  return sum;
}

TEST(SampleShares, EqualNoiseGivesEqualShares) {
  EXPECT_EQ(render::allocate_samples(blocks_with({0.3, 0.3, 0.3}, 16), 16), (std::vector<uint32_t>{16, 16, 16}));
  EXPECT_EQ(render::allocate_samples(blocks_with({0.0, 0.0}, 16), 16), (std::vector<uint32_t>{16, 16}));
  EXPECT_EQ(render::allocate_samples(blocks_with({0.3, 0.3}, 0), 1), (std::vector<uint32_t>{1, 1}));
}

TEST(SampleShares, AllSamplesTogetherAreInProportionToTheNoise) {
  const auto counts = render::allocate_samples(blocks_with({1.0, 2.0, 1.5, 1.5}, 16), 32);
  EXPECT_EQ(counts, (std::vector<uint32_t>{16, 48, 32, 32}));
}

TEST(SampleShares, ABlockAboveItsShareTakesTheMinimum) {
  auto blocks = blocks_with({1.0, 1.0}, 16);
  blocks[0].taken = 100;
  const auto counts = render::allocate_samples(blocks, 16);
  EXPECT_EQ(counts[0], 2u);
  EXPECT_EQ(counts[1], 30u);
}

TEST(SampleShares, ABatchHasItsMeanAndItsCountsAreEven) {
  for (const uint32_t mean : {4u, 7u, 16u}) {
    std::vector<render::BlockShare> blocks;
    for (int i = 0; i < 200; ++i)
      blocks.push_back(
          {i % 10 == 9 ? 48 : kPixels, uint32_t(16 + 2 * (i % 5)), std::exp(0.03 * (i * 37 % 100)), i % 7 != 3});
    double pixels = 0.0;
    const auto counts = render::allocate_samples(blocks, mean);
    for (size_t i = 0; i < blocks.size(); ++i) {
      if (!blocks[i].continues) {
        EXPECT_EQ(counts[i], 0u);
        continue;
      }
      pixels += double(blocks[i].pixels);
      EXPECT_GE(counts[i], 2u);
      EXPECT_EQ(counts[i] % 2, 0u);
    }
    EXPECT_NEAR(given(blocks, counts), mean * pixels, 2.0 * kPixels) << mean;
  }
}

TEST(SampleShares, NoBlockStarvesAndNoneTakesAll) {
  std::vector<double> spreads(100, 1.0);
  spreads[0] = 1e3;
  spreads[1] = 0.0;
  const auto counts = render::allocate_samples(blocks_with(spreads, 32), 32);
  EXPECT_EQ(32 + counts[0], uint32_t(render::kMaxShare * 64));
  EXPECT_EQ(counts[1], 2u);  // the block has half of the mean already
}

TEST(SampleShares, ANoiseThatIsNotFiniteCountsAsTheMaximum) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(render::allocate_samples(blocks_with({1.0, nan, 2.0, infinity}, 16), 16),
            render::allocate_samples(blocks_with({1.0, 2.0, 2.0, 2.0}, 16), 16));
}

TEST(SampleShares, TheErrorIsBelowThatOfEqualShares) {
  std::vector<double> spreads;
  for (int i = 0; i < 64; ++i) spreads.push_back(std::exp(0.02 * i));
  const auto counts = render::allocate_samples(blocks_with(spreads, 16), 48);
  double shared = 0.0, equal = 0.0, minimum = 0.0;
  for (size_t i = 0; i < spreads.size(); ++i) {
    shared += spreads[i] * spreads[i] / (16.0 + counts[i]);
    equal += spreads[i] * spreads[i] / 64.0;
    minimum += spreads[i] / 64.0;
  }
  minimum *= minimum;  // Cauchy-Schwarz: (mean s)² / n, of 64 blocks with 64 samples
  EXPECT_LT(shared, 0.95 * equal);
  EXPECT_NEAR(shared, minimum, 0.01 * minimum);
}

}  // namespace
}  // namespace gradus::sample_allocation_test
