// B2 for least squares weighted by the measured noise, from which the noise of L1 is estimated.
#include <gtest/gtest.h>

#include "reconstruct/poisson/minimise_by_noise.h"
#include "reconstruct/test_images.h"

namespace gradus::minimise_by_noise_test {
namespace {

using namespace test;

std::vector<float> solve(const film::GradientImages& images, reconstruct::SolveReport* report) {
  const reconstruct::Minimum minimum = reconstruct::minimise_by_noise(images, never, report);
  return make_image(images.width, images.height, 3, [&](int x, int y, int c) { return minimum.solution.row(y, c)[x]; });
}

// The solver stops when the worst row is within a hundredth of its noise, not at a residual, which is dominated by
// bright values (CgGoal): here at 1.1e-3 at most, where L1 continues to 1e-4.
TEST(B2_ByNoise, ReportsItsResidual) {
  for (const auto& [w, h] : kSizes) {
    reconstruct::SolveReport report;
    solve(noisy_images(w, h), &report);
    EXPECT_LE(report.residual, 2e-3f) << w << "x" << h;
    EXPECT_FALSE(report.hit_cap);
  }
}

// Half of the picture has useless differences, the other half useless pixels: no single alpha fits both.
TEST(B2_ByNoise, UsesTheNoiseOfEachPlace) {
  const int w = 96, h = 64;
  const std::vector<float> truth = smooth_image(w, h, 3);
  const auto left = [&](size_t i) { return int(i) % w < w / 2; };
  const film::GradientImages images = noisy_images(
      w, h, 3, truth, [&](size_t i) { return left(i) ? 0.01f : 1.0f; },
      [&](size_t i) { return left(i) ? 1.0f : 0.01f; });
  reconstruct::SolveReport report;
  const double by_noise = rms_difference(solve(images, &report), truth);
  for (const float alpha : {0.1f, 0.4f, 1.0f, 3.0f}) {
    const auto l2 = reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, alpha, never, &report);
    EXPECT_LT(by_noise, 0.6 * rms_difference(l2, truth)) << alpha;
  }
}

// A firefly in one half-buffer is recognised by its own deviation.
TEST(B2_ByNoise, IgnoresOutliersOfOneHalf) {
  const int w = 64, h = 48;
  const std::vector<float> truth = smooth_image(w, h, 3);
  film::GradientImages images = noisy_images(
      w, h, 3, truth, [](size_t) { return 0.1f; }, [](size_t) { return 0.01f; });
  for (const size_t pixel : {700u, 1501u, 2222u}) {
    for (int c = 0; c < 3; ++c) {
      images.primal[3 * pixel + c] += 5e3f;
      images.dy[3 * (pixel + 200) + c] -= 50.0f;
    }
    images.primal_deviation[pixel] = 5e3f;
    images.dy_deviation[pixel + 200] = 50.0f;
  }
  reconstruct::SolveReport report;
  const double by_noise = rms_difference(solve(images, &report), truth);
  EXPECT_LT(by_noise, 0.05);
  EXPECT_GT(rms_difference(reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.4f, never, &report), truth),
            20 * by_noise);
}

// Regression: beside a light of 30,000, the relative residual was small at once, and the solver left dark areas of its
// start.
TEST(B2_ByNoise, IsNotStoppedByAVisibleLight) {
  const int w = 96, h = 64;
  const auto lit = [&](size_t pixel) { return pixel % w >= 60 && pixel % w < 70 && pixel / w >= 20 && pixel / w < 30; };
  const auto solve_beside = [&](float light) {
    std::vector<float> truth = smooth_image(w, h, 3);
    for (size_t i = 0; i < truth.size(); ++i) truth[i] += lit(i / 3) ? light : 0.0f;
    film::GradientImages images = noisy_images(
        w, h, 3, truth, [](size_t) { return 0.3f; }, [](size_t i) { return i % 37 == 0 ? 10.0f : 0.01f; });
    reconstruct::SolveReport report;
    std::vector<float> result = solve(images, &report);
    EXPECT_FALSE(report.hit_cap);
    for (size_t i = 0; i < result.size(); ++i) result[i] = lit(i / 3) ? 0.0f : result[i] - truth[i];
    return result;
  };
  const std::vector<float> none(size_t(w) * h * 3, 0.0f);
  const double without = rms_difference(solve_beside(0.0f), none);
  EXPECT_LT(without, 0.1);
  EXPECT_LT(rms_difference(solve_beside(3e4f), none), 1.2 * without);
}

// Regression: with noise over six decades between neighbouring areas, the matrix was singular in single precision, and
// the solution of the order of 10⁷.
TEST(B2_ByNoise, DoesNotDivergeOverDecadesOfNoise) {
  const int w = 128, h = 96;
  const std::vector<float> truth = smooth_image(w, h, 3);
  const auto area = [&](size_t i, float scale) {
    return 0.5f + 0.5f * std::sin(scale * float(i % w) + 1.3f * std::sin(scale * float(i / w)));
  };
  const film::GradientImages images = noisy_images(
      w, h, 3, truth, [&](size_t i) { return std::pow(10.0f, -3.0f + 6.5f * area(i, 0.21f)); },
      [&](size_t i) { return std::pow(10.0f, -6.0f + 6.0f * area(i, 0.13f)); });
  reconstruct::SolveReport report;
  const std::vector<float> result = solve(images, &report);
  EXPECT_FALSE(report.hit_cap);
  EXPECT_LT(rms_difference(result, truth), 1.0);
}

// With one sample per pixel, one half-buffer is empty and the noise is unknown.
TEST(B2_ByNoise, WithoutKnownNoiseIsNearL2) {
  film::GradientImages images = noisy_images(64, 48);
  for (auto* deviation : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) {
    std::fill(deviation->begin(), deviation->end(), std::numeric_limits<float>::quiet_NaN());
  }
  reconstruct::SolveReport report;
  const std::vector<float> truth = smooth_image(64, 48, 3);
  const double by_noise = rms_difference(solve(images, &report), truth);
  EXPECT_LT(
      by_noise,
      1.2 * rms_difference(reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.4f, never, &report), truth));
}

}  // namespace
}  // namespace gradus::minimise_by_noise_test
