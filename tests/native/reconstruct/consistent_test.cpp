// B1, B2 and equal bits for L1, whose weights of every row are estimated from the images.
#include <gtest/gtest.h>

#include "reconstruct/test_images.h"
#include "support/threads.h"

namespace gradus::consistent_test {
namespace {

using namespace test;

class Consistent : public ::testing::Test {
 protected:
  static std::vector<float> solve(const film::GradientImages& images) {
    reconstruct::SolveReport report;
    const std::vector<float> x = reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L1, 0.2f, never, &report);
    EXPECT_FALSE(report.hit_cap);
    return x;
  }
  // Returns images without noise.
  static film::GradientImages exact(int w, int h, const std::vector<float>& image) {
    return noisy_images(
        w, h, 3, image, [](size_t) { return 0.0f; }, [](size_t) { return 0.0f; });
  }
};

TEST_F(Consistent, B1_KeepsAnImageWithItsOwnGradients) {
  for (const auto& [w, h] : kSizes) {
    const std::vector<float> image = smooth_image(w, h, 3);
    EXPECT_LT(max_difference(solve(exact(w, h, image)), image), 1e-5) << w << "x" << h;
  }
}

// The minimum weights are relative to the image, not absolute.
TEST_F(Consistent, B2_ScalesWithTheImage) {
  film::GradientImages images = noisy_images(64, 48);
  std::vector<float> x = solve(images);
  for (auto* plane :
       {&images.primal, &images.dx, &images.dy, &images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) {
    for (float& v : *plane) v *= 1024.0f;
  }
  const std::vector<float> y = solve(images);
  for (float& v : x) v *= 1024.0f;
  EXPECT_LT(max_difference(x, y), 1e-2 * 1024.0);
}

TEST_F(Consistent, B2_LeavesOutValuesThatAreNotFinite) {
  const std::vector<float> ones(33 * 17 * 3, 1.0f);
  film::GradientImages images = exact(33, 17, ones);
  for (auto* deviation : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation})
    deviation->assign(33 * 17, 0.1f);
  images.primal[41] = std::numeric_limits<float>::quiet_NaN();
  images.dx[90] = std::numeric_limits<float>::infinity();
  images.dy[130] = -std::numeric_limits<float>::infinity();
  EXPECT_LT(max_difference(solve(images), ones), 1e-3);
}

TEST_F(Consistent, B2_ABlackImageIsBlack) {
  const std::vector<float> black(16 * 16 * 3, 0.0f);
  EXPECT_EQ(solve(exact(16, 16, black)), black);
}

// The weights are fixed: a fourth channel uses those of the first three, and components add up.
TEST_F(Consistent, B2_WeightsAreALinearOperator) {
  const film::GradientImages images = noisy_images(48, 32, 4);
  const size_t pixels = 48 * 32;
  // Returns the solution with factors of the first two channels in the fourth.
  const auto solve_with = [&](float first, float second) {
    film::GradientImages changed = images;
    for (auto* plane : {&changed.primal, &changed.dx, &changed.dy}) {
      for (size_t i = 0; i < pixels; ++i) (*plane)[4 * i + 3] = first * (*plane)[4 * i] + second * (*plane)[4 * i + 1];
    }
    return solve(changed);
  };
  const std::vector<float> a = solve_with(1, 0), b = solve_with(0, 1), sum = solve_with(1, 1);
  for (size_t i = 3; i < 4 * pixels; i += 4) {
    EXPECT_NEAR(a[i] + b[i], sum[i], 1e-3) << i;
    // The solution returned with the weights is the one that they give.
    EXPECT_NEAR(a[i], a[i - 3], 1e-2) << i;
  }
}

TEST_F(Consistent, L1_SameBitsForAnyNumberOfThreads) {
  const film::GradientImages images = noisy_images(133, 71);
  test::expect_same_bits_for_any_number_of_threads([&] { return solve(images); });
}

}  // namespace
}  // namespace gradus::consistent_test
