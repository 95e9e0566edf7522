// Filtering of the noise of features.
#include "reconstruct/regression/feature_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace gradus::feature_filter_test {
namespace {

constexpr int kWidth = 60, kHeight = 40;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

// An image that is half white and half dark, with noise of the given deviation in the means of both half-buffers.
struct Noisy {
  explicit Noisy(float deviation, uint32_t channels = 3, int width = kWidth, int height = kHeight, float unit = 1.0f) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    image.channels = channels;
    for (int i = 0; i < width * height; ++i) {
      for (uint32_t c = 0; c < channels; ++c) {
        truth.push_back(unit * (i % width < width / 2 ? 0.8f : 0.2f));
        const float a = deviation * normal(random), b = deviation * normal(random);
        image.values.push_back(truth.back() + unit * 0.5f * (a + b));
        image.variance.push_back(unit * unit * 0.25f * (a - b) * (a - b));
      }
    }
  }
  film::FeatureImage image;
  std::vector<float> truth;
};

double mean_square(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += double(a[i] - b[i]) * double(a[i] - b[i]);
  return sum / double(a.size());
}

TEST(FeatureFilter, RemovesNoiseAndKeepsTheEdge) {
  const Noisy noisy(0.1f);
  const film::FeatureImage clean = reconstruct::filter_feature(noisy.image, kWidth, kHeight);
  // The mean of nine pixels with equal weights has a ninth of the variance.
  EXPECT_LT(mean_square(clean.values, noisy.truth), mean_square(noisy.image.values, noisy.truth) / 5.0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x : {kWidth / 2 - 1, kWidth / 2}) {
      const size_t i = 3 * size_t(y * kWidth + x);
      EXPECT_NEAR(clean.values[i], noisy.truth[i], 0.25f) << x << ' ' << y;
    }
  }
  EXPECT_EQ(clean.variance, noisy.image.variance);
}

TEST(FeatureFilter, CleanFeaturesStay) {
  const Noisy clean(0.0f);
  const film::FeatureImage filtered = reconstruct::filter_feature(clean.image, kWidth, kHeight);
  for (size_t i = 0; i < clean.truth.size(); ++i) ASSERT_NEAR(filtered.values[i], clean.truth[i], 1e-4f);
}

// A texture of a fiftieth of the feature, which no noise explains.
TEST(FeatureFilter, FineTextureWithoutNoiseStays) {
  Noisy clean(0.0f, 1);
  for (size_t i = 0; i < clean.truth.size(); ++i)
    clean.truth[i] = clean.image.values[i] = 0.5f + (i % 2 ? 0.01f : -0.01f);
  const film::FeatureImage filtered = reconstruct::filter_feature(clean.image, kWidth, kHeight);
  EXPECT_LT(std::sqrt(mean_square(filtered.values, clean.truth)), 1e-4);
}

// The pixels of a checkerboard, which differ by twice their deviation, are partly averaged. With an estimated variance
// of a quarter of the true one they would hardly be averaged, with four times that almost completely.
TEST(FeatureFilter, DifferencesCountByTheVariance) {
  Noisy noisy(0.0f, 1);
  const auto chequer = [](size_t i) { return (i % kWidth + i / kWidth) % 2 ? 0.1f : -0.1f; };
  for (size_t i = 0; i < noisy.truth.size(); ++i) noisy.image.values[i] = 0.5f + chequer(i);
  std::fill(noisy.image.variance.begin(), noisy.image.variance.end(), 0.01f);
  const film::FeatureImage filtered = reconstruct::filter_feature(noisy.image, kWidth, kHeight);
  double left = 0.0;
  for (size_t i = 0; i < filtered.values.size(); ++i)
    left += filtered.values[i] * chequer(i) / (0.01 * double(filtered.values.size()));
  EXPECT_GT(left, 0.4);
  EXPECT_LT(left, 0.95);
}

// Regression: pixels at the border had a smaller estimate of the noise, as if pixels outside had neither noise nor
// differences.
TEST(FeatureFilter, AtTheBorderNeighboursHaveTheSameWeights) {
  Noisy noisy(0.0f, 1);
  const auto chequer = [](int x, int y) { return (x + y) % 2 ? 0.1f : -0.1f; };
  for (int i = 0; i < kWidth * kHeight; ++i) noisy.image.values[size_t(i)] = 0.5f + chequer(i % kWidth, i / kWidth);
  std::fill(noisy.image.variance.begin(), noisy.image.variance.end(), 0.01f);
  const film::FeatureImage filtered = reconstruct::filter_feature(noisy.image, kWidth, kHeight);
  // Neighbours at the sides differ by 0.2, where noise explains √0.02: (0.04 − 0.02)/(k² 0.02) = 2 variances.
  const float side = 1.0f / std::pow(1.0f + 0.25f * 2.0f, 4.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float columns = x == 0 || x == kWidth - 1 ? 1.0f : 2.0f, rows = y == 0 || y == kHeight - 1 ? 1.0f : 2.0f;
      const float same = 1.0f + columns * rows, opposite = (columns + rows) * side;
      const float expected = 0.5f + chequer(x, y) * (same - opposite) / (same + opposite);
      ASSERT_NEAR(filtered.values[size_t(y * kWidth + x)], expected, 2e-3f) << x << ' ' << y;
    }
  }
}

// Each neighbour is weighted by its own distance; those to the left are read from another place than those to the
// right.
TEST(FeatureFilter, AMirroredPictureIsFilteredAlike) {
  const auto mirrored = [](std::vector<float> values) {
    std::reverse(values.begin(), values.end());
    return values;
  };
  Noisy noisy(0.1f, 1);
  const std::vector<float> expected = mirrored(reconstruct::filter_feature(noisy.image, kWidth, kHeight).values);
  noisy.image.values = mirrored(noisy.image.values);
  noisy.image.variance = mirrored(noisy.image.variance);
  const film::FeatureImage filtered = reconstruct::filter_feature(noisy.image, kWidth, kHeight);
  for (size_t i = 0; i < expected.size(); ++i)
    ASSERT_NEAR(filtered.values[i], expected[i], 1e-3f) << i % kWidth << ' ' << i / kWidth;
}

TEST(FeatureFilter, DoesNotDependOnTheUnit) {
  const Noisy small(0.1f, 1), large(0.1f, 1, kWidth, kHeight, 1000.0f);
  const film::FeatureImage a = reconstruct::filter_feature(small.image, kWidth, kHeight),
                           b = reconstruct::filter_feature(large.image, kWidth, kHeight);
  for (size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(b.values[i], 1000.0f * a.values[i], 0.02f);
}

// If a row or column is removed beyond the reach of the filter, the rest is the same: tiles read enough of their
// surroundings.
TEST(FeatureFilter, TilesLeaveNoSeams) {
  constexpr int kWide = 600, kTall = 70, kCut = 5, kEdge = 3;
  const Noisy noisy(0.1f, 1, kWide, kTall);
  const film::FeatureImage whole = reconstruct::filter_feature(noisy.image, kWide, kTall);
  film::FeatureImage part{1, {}, {}};
  for (int y = kCut; y < kTall; ++y) {
    for (int x = kCut; x < kWide; ++x) {
      part.values.push_back(noisy.image.values[size_t(y * kWide + x)]);
      part.variance.push_back(noisy.image.variance[size_t(y * kWide + x)]);
    }
  }
  part = reconstruct::filter_feature(std::move(part), kWide - kCut, kTall - kCut);
  for (int y = kEdge; y < kTall - kCut; ++y) {
    for (int x = kEdge; x < kWide - kCut; ++x) {
      const float expected = whole.values[size_t((y + kCut) * kWide + x + kCut)];
      ASSERT_NEAR(part.values[size_t(y * (kWide - kCut) + x)], expected, 1e-3f) << x << ' ' << y;
    }
  }
}

TEST(FeatureFilter, UnknownNoiseCountsAsNone) {
  Noisy noisy(0.1f);
  std::fill(noisy.image.variance.begin(), noisy.image.variance.end(), kNaN);
  const film::FeatureImage filtered = reconstruct::filter_feature(noisy.image, kWidth, kHeight);
  EXPECT_LT(mean_square(filtered.values, noisy.image.values), 0.1 * mean_square(noisy.image.values, noisy.truth));
}

TEST(FeatureFilter, ValuesThatAreNotFiniteAffectNothingElse) {
  Noisy noisy(0.05f);
  noisy.image.values[3 * 500] = kNaN;
  noisy.image.values[3 * 900 + 1] = kInfinity;
  noisy.image.values[3 * 1300 + 2] = -std::numeric_limits<float>::max();
  noisy.image.variance[3 * 700] = std::numeric_limits<float>::max();
  const film::FeatureImage filtered = reconstruct::filter_feature(noisy.image, kWidth, kHeight);
  size_t off = 0;
  for (size_t i = 0; i < filtered.values.size(); ++i) {
    ASSERT_TRUE(std::isfinite(filtered.values[i])) << i;
    off += std::fabs(filtered.values[i] - noisy.truth[i]) > 0.3f;
  }
  EXPECT_LE(off, 27u);
}

TEST(FeatureFilter, ImagesOfOnePixelRowAndColumn) {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 50}, {50, 1}, {2, 2}, {3, 1}}) {
    const Noisy noisy(0.1f, 1, w, h);
    const film::FeatureImage filtered = reconstruct::filter_feature(noisy.image, w, h);
    ASSERT_EQ(filtered.values.size(), size_t(w) * size_t(h));
    for (size_t i = 0; i < filtered.values.size(); ++i)
      EXPECT_NEAR(filtered.values[i], noisy.truth[i], 0.3f) << w << 'x' << h;
    if (w * h == 1) {
      EXPECT_EQ(filtered.values, noisy.image.values);
    }
  }
}

}  // namespace
}  // namespace gradus::feature_filter_test
