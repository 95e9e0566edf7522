// Pixels without noise are not changed.
#include <gtest/gtest.h>

#include "reconstruct/poisson/noise_free.h"
#include "reconstruct/test_images.h"

namespace gradus::noise_free_test {
namespace {

using namespace test;

constexpr int kSide = 96;
constexpr int kFirst = 30, kLast = 60;  // of the square that has noise

bool has_noise(int x, int y) { return x >= kFirst && x <= kLast && y >= kFirst && y <= kLast; }

// Returns a bright object with noise, in a background whose samples are all equal.
film::GradientImages object_in_background() {
  const auto truth = make_image(kSide, kSide, 3, [](int x, int y, int) { return has_noise(x, y) ? 1.0f : 0.25f; });
  film::GradientImages images = with_exact_gradients(kSide, kSide, 3, truth);
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0.0f, 0.3f);
  for (auto* plane : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation})
    plane->assign(size_t(kSide) * kSide, 0.0f);
  for (int y = kFirst; y <= kLast; ++y) {
    for (int x = kFirst; x <= kLast; ++x) {
      const size_t i = size_t(y) * kSide + size_t(x);
      for (int c = 0; c < 3; ++c) images.primal[3 * i + c] += normal(random);
      images.primal_deviation[i] = 0.3f;
      images.dx_deviation[i] = images.dy_deviation[i] = 0.01f;
    }
  }
  return images;
}

TEST(NoiseFree, ArePixelsWhoseNeighboursHaveNoNoiseEither) {
  const auto settled = reconstruct::find_noise_free(object_in_background());
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const bool far = x < kFirst - 1 || y < kFirst - 1 || x > kLast + 2 || y > kLast + 2;
      const bool near = x >= kFirst - 1 && y >= kFirst - 1 && x <= kLast + 1 && y <= kLast + 1;
      if (far || near) {
        EXPECT_EQ(settled[size_t(y) * kSide + size_t(x)], far ? 1 : 0) << x << " " << y;
      }
    }
  }
  const Region box = reconstruct::noisy_region(settled, kSide, kSide);
  EXPECT_EQ(box.x0, kFirst - 2);
  EXPECT_LE(box.x1, kLast + 4);
}

// Regression: twicing spread the noise of an object over five pixels of a background that was known exactly.
TEST(NoiseFree, BackgroundKeepsItsBitsAndTheObjectItsReconstruction) {
  const film::GradientImages images = object_in_background();
  const auto settled = reconstruct::find_noise_free(images);
  reconstruct::SolveReport report;
  const auto result = reconstruct::reconstruct_noisy_region(images, GRADUS_RECONSTRUCTION_L1, 0.0f, never, &report),
             whole = reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L1, 0.0f, never, &report);
  double error = 0.0, noise = 0.0, change = 0.0;
  for (size_t i = 0; i < settled.size(); ++i) {
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      if (settled[i]) {
        ASSERT_EQ(result[k], images.primal[k]);
        continue;
      }
      const double truth = has_noise(int(i) % kSide, int(i) / kSide) ? 1.0 : 0.25;
      error += (result[k] - truth) * (result[k] - truth);
      noise += (images.primal[k] - truth) * (images.primal[k] - truth);
      change += (result[k] - whole[k]) * (result[k] - whole[k]);
    }
  }
  EXPECT_LT(error, 0.3 * noise);
  EXPECT_LT(change, 0.1 * error);
}

TEST(NoiseFree, AnImageWithoutNoiseIsKept) {
  film::GradientImages images = with_exact_gradients(20, 10, 3, smooth_image(20, 10, 3));
  for (auto* plane : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) plane->assign(200, 0.0f);
  reconstruct::SolveReport report;
  EXPECT_EQ(reconstruct::reconstruct_noisy_region(images, GRADUS_RECONSTRUCTION_L1, 0.0f, never, &report),
            images.primal);
  EXPECT_EQ(report.inner_steps, 0);
}

// In a black pixel, light may be too rare to have been sampled. Where there is no surface, there is none.
TEST(NoiseFree, BlackPixelsAreNotButTransparentOnesAre) {
  for (const float alpha : {0.0f, 1.0f}) {
    film::GradientImages images =
        with_exact_gradients(8, 8, 4, make_image(8, 8, 4, [alpha](int, int, int c) { return c == 3 ? alpha : 0.0f; }));
    for (auto* plane : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) plane->assign(64, 0.0f);
    EXPECT_EQ(reconstruct::find_noise_free(images), std::vector<uint8_t>(64, alpha == 0.0f));
  }
}

TEST(NoiseFree, MissingPixelsAreNot) {
  film::GradientImages images = with_exact_gradients(9, 9, 3, smooth_image(9, 9, 3));
  for (auto* plane : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) plane->assign(81, 0.0f);
  images.dx_deviation[4 * 9 + 4] = film::kAbsentPair;
  const auto settled = reconstruct::find_noise_free(images);
  EXPECT_FALSE(settled[4 * 9 + 4]);
  EXPECT_FALSE(settled[4 * 9 + 6]);
  EXPECT_TRUE(settled[4 * 9 + 7]);
}

}  // namespace
}  // namespace gradus::noise_free_test
