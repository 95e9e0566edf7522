// B1, B2 for regression in windows.
#include "reconstruct/regression/local_regression.h"

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"
#include "reconstruct/test_images.h"
#include "support/threads.h"

namespace gradus::local_regression_test {
namespace {

using namespace test;

// Windows of 4, 8 and 16 pixels.
constexpr int kSizes = 3, kReach = 16;
const reconstruct::RegressionSettings kSettings{.octaves = {{.side = 2, .small = true}, {.side = 4}},
                                                .lattices = 2,
                                                .coordinates = true,
                                                .ridge = 3e-4f,
                                                .floor = 1e-4f};

reconstruct::Field make_field(int w, int h, int channels, const std::function<float(int, int, int)>& value) {
  reconstruct::Field field(w, h, channels);
  for (int y = 0; y < h; ++y) {
    for (int c = 0; c < channels; ++c) {
      for (int x = 0; x < w; ++x) field.row(y, c)[x] = value(x, y, c);
    }
  }
  return field;
}

float feature(int x, int y, int c) {
  return std::sin(0.9f * float(x) * float(c + 1) + 0.37f * float(y * y) * float(c + 2));
}
reconstruct::Field features(int w, int h) { return make_field(w, h, 7, feature); }
// Returns the samples of a single picture. `own`: weights of pixels' own values; empty: they do not count.
reconstruct::RegressionSamples samples(reconstruct::Field features, reconstruct::Field weights,
                                       reconstruct::Field own = {}) {
  auto in_windows =
      std::make_shared<const reconstruct::Predictors>(reconstruct::Predictors{std::move(features), std::move(weights)});
  if (own.width() == 0) return {std::move(in_windows)};
  return {std::move(in_windows), std::make_shared<const reconstruct::Field>(std::move(own))};
}
reconstruct::RegressionResult estimate(reconstruct::LocalRegression* regression, const reconstruct::Field& mean,
                                       const reconstruct::Field& half_difference) {
  return regression->estimate({&mean, &mean}, {&half_difference, &half_difference}, never);
}
reconstruct::Field apply(const reconstruct::LocalRegression& regression, const reconstruct::Field& values) {
  return regression.apply({&values, &values}, never);
}
reconstruct::Field ones(int w, int h) {
  return make_field(w, h, 1, [](int, int, int) { return 1.0f; });
}
reconstruct::Field noise(int w, int h, float sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, sigma);
  return make_field(w, h, 3, [&](int, int, int) { return normal(random); });
}

double largest_difference(const reconstruct::Field& a, const reconstruct::Field& b) {
  double worst = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int c = 0; c < a.channels(); ++c) {
      for (int x = 0; x < a.width(); ++x) worst = std::max(worst, std::abs(double(a.row(y, c)[x]) - b.row(y, c)[x]));
    }
  }
  return worst;
}

// Sizes smaller than a window, at the borders of tiles, and one row or column.
constexpr int kRegressionSizes[][2] = {{1, 1}, {1, 40}, {40, 1}, {3, 2}, {80, 128}, {81, 129}, {200, 150}};

TEST(B1_Regression, KeepsImagesThatTheFeaturesExplain) {
  for (const auto& [w, h] : kRegressionSizes) {
    const reconstruct::Field image = make_field(w, h, 3, [](int x, int y, int c) {
      return 5.0f + 0.03f * float(x) - 0.02f * float(y) + 0.5f * feature(x, y, c) - 0.25f * feature(x, y, 6);
    });
    reconstruct::LocalRegression regression(samples(features(w, h), ones(w, h)), kSettings);
    const reconstruct::RegressionResult result = estimate(&regression, image, reconstruct::Field(w, h, 3));
    // The ridge reduces each coefficient slightly, most where windows are small.
    EXPECT_LT(largest_difference(result.mean, image), 0.01) << w << "x" << h;
    EXPECT_EQ(largest_difference(result.noise, reconstruct::Field(w, h, 3)), 0.0);
  }
}

TEST(B2_Regression, IsItsOwnLinearOperator) {
  const int w = 170, h = 140;
  const reconstruct::Field image = noise(w, h, 1.0f, 1), half = noise(w, h, 0.5f, 2), other = noise(w, h, 2.0f, 3);
  reconstruct::LocalRegression regression(samples(features(w, h), ones(w, h), ones(w, h)), kSettings);
  const reconstruct::RegressionResult result = estimate(&regression, image, half);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT(largest_difference(apply(regression, reconstruct::channels_of(image, c, 1)),
                                 reconstruct::channels_of(result.mean, c, 1)),
              1e-4);
    EXPECT_LT(largest_difference(apply(regression, reconstruct::channels_of(half, c, 1)),
                                 reconstruct::channels_of(result.noise, c, 1)),
              1e-4);
  }
  const reconstruct::Field sum =
      make_field(w, h, 1, [&](int x, int y, int) { return image.row(y, 0)[x] - 3.0f * other.row(y, 0)[x]; });
  const reconstruct::Field a = apply(regression, reconstruct::channels_of(image, 0, 1)),
                           b = apply(regression, reconstruct::channels_of(other, 0, 1));
  const reconstruct::Field expected =
      make_field(w, h, 1, [&](int x, int y, int) { return a.row(y)[x] - 3.0f * b.row(y)[x]; });
  EXPECT_LT(largest_difference(apply(regression, sum), expected), 1e-4);
}

TEST(B2_Regression, HasTheSameBitsForAnyNumberOfThreads) {
  const int w = 170, h = 140;
  const reconstruct::Field image = noise(w, h, 1.0f, 1), half = noise(w, h, 0.5f, 2);
  expect_same_bits_for_any_number_of_threads([&] {
    reconstruct::LocalRegression regression(samples(features(w, h), ones(w, h)), kSettings);
    const reconstruct::Field mean = estimate(&regression, image, half).mean;
    std::vector<float> values;
    for (int y = 0; y < h; ++y) values.insert(values.end(), mean.row(y, 1), mean.row(y, 1) + w);
    return values;
  });
}

// If the features explain the picture, the error is what the operator leaves of half the difference of the
// half-buffers, no more and no less.
TEST(B2_Regression, EstimatesItsNoise) {
  const int w = 160, h = 120;
  double estimated = 0.0, actual = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const reconstruct::Field a = noise(w, h, 0.5f, seed), b = noise(w, h, 0.5f, 100 + seed);
    const auto truth = [](int x, int y, int c) { return 2.0f + 0.5f * feature(x, y, c); };
    const reconstruct::Field image = make_field(
        w, h, 3, [&](int x, int y, int c) { return truth(x, y, c) + 0.5f * (a.row(y, c)[x] + b.row(y, c)[x]); });
    const reconstruct::Field half =
        make_field(w, h, 3, [&](int x, int y, int c) { return 0.5f * (a.row(y, c)[x] - b.row(y, c)[x]); });
    reconstruct::LocalRegression regression(samples(features(w, h), ones(w, h)), kSettings);
    const reconstruct::RegressionResult result = estimate(&regression, image, half);
    for (int y = 0; y < h; ++y) {
      for (int c = 0; c < 3; ++c) {
        for (int x = 0; x < w; ++x) {
          estimated += result.noise.row(y, c)[x] * result.noise.row(y, c)[x];
          actual += std::pow(result.mean.row(y, c)[x] - truth(x, y, c), 2.0);
        }
      }
    }
  }
  EXPECT_NEAR(estimated / actual, 1.0, 0.15);
  EXPECT_LT(actual, 0.15 * 4.0 * 3.0 * w * h * 0.125);  // of the noise of the mean, 0.5²/2
}

// Windows are weighted by the inverse of their squared error, which is known here: only the coordinates are features,
// so that a checkerboard is all bias, checkerboard noise is almost removed, and constant noise remains.
struct KnownError {
  float picture, chequered_noise, common_noise;
  double error() const { return picture * picture - chequered_noise * chequered_noise + common_noise * common_noise; }
};

reconstruct::LocalRegression regress(const KnownError& known, float own, reconstruct::RegressionResult* result) {
  const int w = 96, h = 80;
  const reconstruct::Field image =
      make_field(w, h, 3, [&](int x, int y, int) { return 5.0f + known.picture * chequer(x, y); });
  const reconstruct::Field half = make_field(
      w, h, 3, [&](int x, int y, int) { return known.common_noise + known.chequered_noise * chequer(x, y); });
  const reconstruct::Field own_weights = make_field(w, h, 1, [&](int, int, int) { return own; });
  reconstruct::LocalRegression regression(samples(reconstruct::Field(w, h, 7), ones(w, h), own_weights), kSettings);
  *result = estimate(&regression, image, half);
  return regression;
}

// Returns the mean of function(x, y) over pixels that no window at the border covers.
template <class Function>
double inner_mean(const reconstruct::Field& field, const Function& function) {
  double sum = 0.0;
  int count = 0;
  for (int y = kReach; y < field.height() - kReach; ++y) {
    for (int x = kReach; x < field.width() - kReach; ++x, ++count) sum += function(x, y);
  }
  return sum / count;
}

TEST(B2_Regression, PixelsAndWindowsAreWeightedByTheirErrors) {
  for (const KnownError known :
       {KnownError{2.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 2.0f}, {2.0f, 0.0f, 2.0f}, {3.0f, 2.0f, 1.0f}}) {
    const auto own = static_cast<float>(kSizes / known.error());  // as much as all windows together
    reconstruct::RegressionResult result;
    const reconstruct::LocalRegression with = regress(known, own, &result), without = regress(known, 0.0f, &result);
    const reconstruct::Field probe =
        make_field(result.bias.width(), result.bias.height(), 1, [](int x, int y, int) { return chequer(x, y); });
    const reconstruct::Field blended = apply(with, probe), of_windows = apply(without, probe);
    const double share = inner_mean(probe, [&](int x, int y) {
      return (blended.row(y)[x] - of_windows.row(y)[x]) / (probe.row(y)[x] - of_windows.row(y)[x]);
    });
    EXPECT_NEAR(share, 0.5, 0.02) << known.picture << ", " << known.chequered_noise << ", " << known.common_noise;
    const double bias = inner_mean(probe, [&](int x, int y) { return result.bias.row(y)[x]; });
    EXPECT_NEAR(bias, known.error() - known.common_noise * known.common_noise, 0.02 * known.error());
  }
}

// Regression: a shelf of five dark rows between bright ones, far from the centre of the tile, got a tenth of their
// brightness: slopes of hundreds with a constant of thousands exceed the precision of floats.
TEST(B2_Regression, AShelfStaysDarkFarFromTheTilesCentre) {
  const int w = 160, h = 120;
  const reconstruct::Field image = make_field(w, h, 3, [](int, int y, int) { return y % 20 < 5 ? 0.3f : 30.0f; });
  const reconstruct::Field none = make_field(w, h, 7, [](int, int, int c) { return c == 1 ? 1.0f : 0.0f; });
  reconstruct::LocalRegression regression(samples(none, ones(w, h)), kSettings);
  const reconstruct::RegressionResult result = estimate(&regression, image, reconstruct::Field(w, h, 3));
  for (int x = 8; x < w - 8; ++x) {
    for (const int y : {22, 42, 62, 82, 102}) EXPECT_NEAR(result.mean.row(y)[x], 0.3f, 0.1f) << x << " " << y;
  }
}

TEST(B2_Regression, LeavesOutPixelsWithoutWeight) {
  const int w = 64, h = 48;
  reconstruct::Field image = make_field(w, h, 3, [](int x, int, int) { return 1.0f + 0.01f * float(x); });
  reconstruct::Field weights = ones(w, h);
  const reconstruct::Field truth = image;
  for (int y = 0; y < h; ++y) {
    for (int x = (y * 7) % 5; x < w; x += 5) {
      weights.row(y)[x] = 0.0f;
      for (int c = 0; c < 3; ++c) image.row(y, c)[x] = 1e4f;
    }
  }
  reconstruct::LocalRegression regression(samples(features(w, h), weights), kSettings);
  EXPECT_LT(largest_difference(estimate(&regression, image, reconstruct::Field(w, h, 3)).mean, truth), 0.03);
}

// There is light in a corner only: tiles that contain none are skipped, with the same result as if they were computed.
TEST(B1_Regression, SkipsBlackTiles) {
  constexpr int w = 700, h = 900, corner = 60;
  reconstruct::Field mean = noise(w, h, 1.0f, 1), half = noise(w, h, 0.3f, 2);
  for (reconstruct::Field* field : {&mean, &half}) {
    for (int y = 0; y < h; ++y) {
      for (int c = 0; c < 3; ++c) {
        for (int x = 0; x < w; ++x) field->row(y, c)[x] *= x < corner && y < corner ? 1.0f : 0.0f;
      }
    }
  }
  const auto hardly_anything =
      make_field(w, h, 3, [](int x, int y, int) { return x < corner && y < corner ? 0.0f : 1e-12f; });
  reconstruct::Field seen = mean;
  for (int y = 0; y < h; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < w; ++x) seen.row(y, c)[x] += hardly_anything.row(y, c)[x];
    }
  }
  const auto shared = samples(features(w, h), ones(w, h), ones(w, h));
  reconstruct::LocalRegression passing(shared, kSettings), working(shared, kSettings);
  const reconstruct::RegressionResult a = estimate(&passing, mean, half), b = estimate(&working, seen, half);
  EXPECT_LT(largest_difference(a.mean, b.mean), 1e-5);
  EXPECT_LT(largest_difference(a.noise, b.noise), 1e-5);
  EXPECT_LT(largest_difference(a.bias, b.bias), 1e-5);
  // The weights are kept there, too.
  const reconstruct::Field other = reconstruct::channels_of(noise(w, h, 1.0f, 3), 0, 1);
  EXPECT_LT(largest_difference(apply(passing, other), apply(working, other)), 1e-4);
}

}  // namespace
}  // namespace gradus::local_regression_test
