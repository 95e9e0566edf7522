// Whether the samples of two frames show the same light.
#include "reconstruct/space_time/light_test.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"
#include "reconstruct/test_images.h"
#include "support/threads.h"

namespace gradus::light_test_test {
namespace {

using namespace test;

constexpr int kWidth = 160, kHeight = 120;

// What may have changed between the samples of two frames, by pixel.
struct LightChange {
  reconstruct::Field difference, variance, weight;
};

// Returns the shares of the pixels, those of their cells.
reconstruct::Field same_light(const LightChange& change) {
  constexpr int kCell = reconstruct::kChangeCell;
  const int w = change.weight.width(), h = change.weight.height();
  reconstruct::Field sums((w + kCell - 1) / kCell, (h + kCell - 1) / kCell, reconstruct::kChangeChannels);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const float weight = change.weight.row(y)[x];
      for (int c = 0; c < 3; ++c) {
        sums.row(y / kCell, c)[x / kCell] += weight * change.difference.row(y, c)[x];
        sums.row(y / kCell, reconstruct::kChangeVariance)[x / kCell] += weight * weight * change.variance.row(y, c)[x];
      }
    }
  }
  const reconstruct::Field kept = reconstruct::same_light(sums);
  return reconstruct::make_field(w, h, [&](int x, int y) { return kept.row(y / kCell)[x / kCell]; });
}

// Returns samples of the same light whose noise has the standard deviation `sigma` of a pixel, which is known.
LightChange noise(float sigma, unsigned seed, int width = kWidth, int height = kHeight) {
  LightChange change{reconstruct::Field(width, height, 3), reconstruct::Field(width, height, 3),
                     reconstruct::make_field(width, height, [](int, int) { return 1.0f; })};
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  for (int y = 0; y < height; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < width; ++x) change.difference.row(y, c)[x] = sigma * normal(random);
    }
  }
  reconstruct::for_values(&change.variance, [sigma](float& value, int, int, int) { value = sigma * sigma; });
  return change;
}

double mean_of(const reconstruct::Field& field, int first_x, int last_x, int first_y, int last_y) {
  double sum = 0.0;
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) sum += field.row(y)[x];
  }
  return sum / (double(last_x - first_x + 1) * (last_y - first_y + 1));
}
double mean_of(const reconstruct::Field& field) { return mean_of(field, 0, field.width() - 1, 0, field.height() - 1); }

TEST(B2_LightTest, NoiseOfTheSameLightIsKept) {
  double kept = 0.0;
  constexpr int kSeeds = 8;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) kept += mean_of(same_light(noise(0.4f, seed))) / kSeeds;
  std::printf("  share that is kept: %.4f\n", kept);
  EXPECT_GT(kept, 0.99);
}

// A step in a square of 16 × 16 pixels is dropped if its mean is `deviations` standard deviations of the mean of a
// square; the noise of a single pixel is 16 times as large.
TEST(C5_LightTest, AStepInASquareIsDropped) {
  constexpr int kSide = 16, kX = 72, kY = 52;
  constexpr float kSigma = 0.4f;
  for (const float deviations : {0.0f, 3.0f, 6.0f, 12.0f}) {
    double inside = 0.0, outside = 0.0;
    constexpr int kSeeds = 8;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      LightChange change = noise(kSigma, seed);
      reconstruct::for_values(&change.difference, [&](float& value, int x, int y, int) {
        if (x >= kX && x < kX + kSide && y >= kY && y < kY + kSide) value += deviations * kSigma / kSide;
      });
      const reconstruct::Field kept = same_light(change);
      inside += mean_of(kept, kX + 4, kX + kSide - 5, kY + 4, kY + kSide - 5) / kSeeds;
      outside += mean_of(kept, 0, kWidth - 1, 0, 10) / kSeeds;
    }
    std::printf("  %g deviations: %.4f kept inside, %.4f far away\n", double(deviations), inside, outside);
    EXPECT_GT(outside, 0.99);
    EXPECT_TRUE(deviations < 6.0f || inside < 0.05) << deviations;
    EXPECT_TRUE(deviations < 12.0f || inside < 0.001) << deviations;
    EXPECT_TRUE(deviations > 0.0f || inside > 0.99);
    EXPECT_LT(inside, deviations < 3.0f ? 1.1 : 0.85) << deviations;
  }
}

// Light without noise, such as that of a source seen directly, is compared exactly.
TEST(C5_LightTest, ADifferenceWithoutNoiseIsDropped) {
  LightChange change = noise(0.0f, 1);
  const reconstruct::Field equal = same_light(change);
  EXPECT_EQ(mean_of(equal), 1.0) << "equal values without noise are the same light";
  reconstruct::for_values(&change.difference, [](float& value, int x, int, int) { value = x < 80 ? 0.0f : 1e-6f; });
  const reconstruct::Field kept = same_light(change);
  EXPECT_EQ(mean_of(kept, 80, kWidth - 1, 0, kHeight - 1), 0.0);
  EXPECT_EQ(mean_of(kept, 0, 39, 0, kHeight - 1), 1.0) << "beyond the largest square";
}

// Pixels without samples count neither for nor against their neighbours.
TEST(B2_LightTest, PixelsWithoutSamplesDoNotCount) {
  LightChange change = noise(0.4f, 1);
  reconstruct::for_values(&change.weight, [](float& value, int x, int, int) { value = x % 3 == 0 ? 0.0f : 1.0f; });
  const reconstruct::Field before = same_light(change);
  reconstruct::for_values(&change.difference, [](float& value, int x, int, int) {
    if (x % 3 == 0) value = 1e6f;
  });
  const reconstruct::Field kept = same_light(change);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(kept.row(y)[x], before.row(y)[x]);
}

// Only the ratio of difference and noise counts.
TEST(B2_LightTest, DoesNotDependOnUnits) {
  LightChange change = noise(0.4f, 1);
  const auto step = [](reconstruct::Field* difference, float value) {
    reconstruct::for_values(difference, [&](float& to, int x, int, int) { to += x < 60 ? value : 0.0f; });
  };
  step(&change.difference, 0.1f);
  const reconstruct::Field expected = same_light(change);
  constexpr float kUnit = 1024.0f, kWeight = 1.0f / 64.0f;
  reconstruct::for_values(&change.difference, [](float& value, int, int, int) { value *= kUnit; });
  reconstruct::for_values(&change.variance, [](float& value, int, int, int) { value *= kUnit * kUnit; });
  reconstruct::for_values(&change.weight, [](float& value, int, int, int) { value *= kWeight; });
  const reconstruct::Field kept = same_light(change);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) ASSERT_NEAR(kept.row(y)[x], expected.row(y)[x], 1e-3f);
}

TEST(B2_LightTest, TestsPicturesOfAnySize) {
  for (const auto& [w, h] : {std::pair(1, 1), {1, 40}, {40, 1}, {3, 2}, {17, 33}}) {
    const reconstruct::Field kept = same_light(noise(0.4f, 1, w, h));
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        EXPECT_GE(kept.row(y)[x], 0.0f);
        EXPECT_LE(kept.row(y)[x], 1.0f);
      }
    }
  }
}

TEST(B2_LightTest, HasTheSameBitsForAnyNumberOfThreads) {
  const LightChange change = noise(0.4f, 1);
  expect_same_bits_for_any_number_of_threads([&] {
    const reconstruct::Field kept = same_light(change);
    std::vector<float> values;
    for (int y = 0; y < kHeight; ++y) values.insert(values.end(), kept.row(y), kept.row(y) + kWidth);
    return values;
  });
}

}  // namespace
}  // namespace gradus::light_test_test
