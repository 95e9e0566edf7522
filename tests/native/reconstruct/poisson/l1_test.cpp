// B1, B2 for the L1 solver.
#include <gtest/gtest.h>

#include "reconstruct/poisson/minimise_l1.h"
#include "reconstruct/poisson/twicing.h"
#include "reconstruct/test_images.h"

namespace gradus::l1_test {
namespace {

using namespace test;

std::vector<float> solve(const film::GradientImages& images, reconstruct::SolveReport* report, float alpha = 0.2f) {
  return reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L1, alpha, never, report);
}

// Returns the objective Σ α‖x−I‖ + ‖Dx−g‖ over all rows, in double.
double energy(const film::GradientImages& images, const std::vector<float>& x, double alpha) {
  const int w = images.width, h = images.height, n = images.channels;
  double sum = 0.0;
  for (int py = 0; py < h; ++py) {
    for (int px = 0; px < w; ++px) {
      double data = 0.0, dx = 0.0, dy = 0.0;
      for (int c = 0; c < n; ++c) {
        const size_t i = (size_t(py) * w + px) * n + c;
        data += std::pow(double(x[i]) - images.primal[i], 2);
        if (px + 1 < w) dx += std::pow(double(x[i + n]) - x[i] - images.dx[i], 2);
        if (py + 1 < h) dy += std::pow(double(x[i + size_t(w) * n]) - x[i] - images.dy[i], 2);
      }
      sum += alpha * std::sqrt(data) + std::sqrt(dx) + std::sqrt(dy);
    }
  }
  return sum;
}

TEST(B2_Solver, L1ReportsItsResidual) {
  for (const auto& [w, h] : kSizes) {
    film::GradientImages images = with_exact_gradients(w, h, 3, smooth_image(w, h, 3));
    add_noise(&images.primal, 0.3f, 1);
    add_noise(&images.dx, 0.05f, 2);
    add_noise(&images.dy, 0.05f, 3);
    reconstruct::SolveReport report;
    solve(images, &report);
    EXPECT_LE(report.residual, 1e-4f) << w << "x" << h;
    EXPECT_FALSE(report.hit_cap);
    EXPECT_GE(report.outer_steps, 3);
    EXPECT_LE(report.outer_steps, 8);
  }
}

std::vector<float> minimise(const film::GradientImages& images) {
  reconstruct::SolveReport report;
  return reconstruct::interleave(reconstruct::minimise_l1(images, 0.2f, never, &report).solution);
}

TEST(B2_Solver, L1LowersItsObjective) {
  film::GradientImages images = with_exact_gradients(64, 48, 3, smooth_image(64, 48, 3));
  add_noise(&images.primal, 0.3f, 1);
  add_noise(&images.dx, 0.02f, 2);
  for (size_t i = 5; i < images.dx.size(); i += 301) images.dx[i] += 3.0f;
  reconstruct::SolveReport report;
  const std::vector<float> l1 = minimise(images),
                           l2 = reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.2f, never, &report);
  const double best = energy(images, l1, 0.2);
  EXPECT_LT(best, 0.95 * energy(images, l2, 0.2));
  // The solution is near a minimum: small random steps do not lower the objective.
  for (unsigned seed = 1; seed < 6; ++seed) {
    std::vector<float> other = l1;
    add_noise(&other, 0.005f, seed);
    EXPECT_GT(energy(images, other, 0.2), best);
  }
}

TEST(B2_Solver, L1IgnoresOutliersInGradientsAndPixels) {
  const std::vector<float> truth = smooth_image(64, 48, 3);
  film::GradientImages images = with_exact_gradients(64, 48, 3, truth);
  add_noise(&images.primal, 0.05f, 1);
  for (const size_t pixel : {700u, 1501u, 2222u}) {
    for (int c = 0; c < 3; ++c) {
      images.primal[3 * pixel + c] = 1e4f;
      images.dy[3 * (pixel + 200) + c] -= 50.0f;
    }
  }
  reconstruct::SolveReport report;
  const double l1 = rms_difference(solve(images, &report), truth);
  const double l2 =
      rms_difference(reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.2f, never, &report), truth);
  EXPECT_LT(l1, 0.03);
  EXPECT_GT(l2, 10 * l1);
}

// Skewed noise with mean 1 and median 0.1. A minimiser alone estimates a median and loses 14 % here; so did an earlier
// version until its data rows got a minimum weight.
TEST(B3_L1, KeepsTheMeanOfSkewedNoise) {
  film::GradientImages images = with_exact_gradients(128, 96, 3, std::vector<float>(128 * 96 * 3, 1.0f));
  add_noise(&images.dx, 0.3f, 2);
  add_noise(&images.dy, 0.3f, 3);
  std::mt19937 random(1);
  for (size_t i = 0; i < images.primal.size(); i += 3) {
    const float value = std::uniform_real_distribution<float>(0.0f, 1.0f)(random) < 0.1f ? 9.1f : 0.1f;
    for (int c = 0; c < 3; ++c) images.primal[i + c] = value;
  }
  reconstruct::SolveReport report;
  EXPECT_LT(mean(minimise(images)) / mean(images.primal), 0.9);
  EXPECT_NEAR(mean(solve(images, &report)) / mean(images.primal), 1.0, 1e-5);
}

TEST(B2_Solver, OutlierBoundGrowsWithTheSquareRootOfTheCount) {
  for (const size_t n : {100u, 1000u, 10000u}) {
    std::vector<float> squares(n, 4.0f);
    const double expected = 4.0 * double(n) / std::log(double(n));
    EXPECT_NEAR(reconstruct::outlier_bound_squared(&squares) / expected, 1.0, 1e-4);
    // ln n outliers of any size hardly reduce the sum of the others.
    std::vector<float> one(n, 4.0f);
    one[n / 2] = 1e30f;
    EXPECT_NEAR(reconstruct::outlier_bound_squared(&one) / (4.0 * double(n - 1) / (std::log(double(n)) - 1.0)), 1.0,
                1e-4);
    // If half of the values are large, they are no outliers.
    std::vector<float> half(n, 4.0f);
    std::fill_n(half.begin(), n / 2, 400.0f);
    EXPECT_GT(reconstruct::outlier_bound_squared(&half), 400.0f);
  }
  std::vector<float> none, single{5.0f}, zeros(100, 0.0f);
  EXPECT_EQ(reconstruct::outlier_bound_squared(&none), kInfinity);
  EXPECT_EQ(reconstruct::outlier_bound_squared(&single), kInfinity);
  EXPECT_EQ(reconstruct::outlier_bound_squared(&zeros), 0.0f);
}

TEST(K2_Cancel, L1EndsAtOnce) {
  const film::GradientImages images = with_exact_gradients(64, 64, 3, smooth_image(64, 64, 3));
  reconstruct::SolveReport report;
  reconstruct::reconstruct(
      images, GRADUS_RECONSTRUCTION_L1, 0.2f, [] { return true; }, &report);
  EXPECT_EQ(report.inner_steps, 0);
}

}  // namespace
}  // namespace gradus::l1_test
