// B1, B2, B3 for the solver that goes by measured noise.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "reconstruct/minimise_by_noise.h"
#include "reconstruct/test_images.h"

namespace gradus {
namespace {

using namespace test;

constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {2, 3}, {33, 17}, {128, 96}};

// The mean of two halves of an image, each with noise of its own, and the deviations that they show. sigma: of a half, by pixel.
template <class Sigma>
void average_noisy_halves(std::vector<float>* mean, std::vector<float>* deviation, int channels, const Sigma& sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  deviation->assign(mean->size() / size_t(channels), 0.0f);
  for (size_t i = 0; i < deviation->size(); ++i) {
    float squares = 0.0f;
    for (int c = 0; c < channels; ++c) {
      const float a = sigma(i) * normal(random), b = sigma(i) * normal(random);
      (*mean)[i * channels + c] += 0.5f * (a + b);
      if (c < 3) squares += (a - b) * (a - b);
    }
    (*deviation)[i] = 0.5f * std::sqrt(squares / 3.0f);
  }
}

template <class PixelSigma, class DifferenceSigma>
GradientImages noisy_images(int w, int h, int channels, const std::vector<float>& truth, const PixelSigma& pixels,
                            const DifferenceSigma& differences) {
  GradientImages images = with_own_gradients(w, h, channels, truth);
  average_noisy_halves(&images.primal, &images.primal_deviation, channels, pixels, 1);
  average_noisy_halves(&images.dx, &images.dx_deviation, channels, differences, 2);
  average_noisy_halves(&images.dy, &images.dy_deviation, channels, differences, 3);
  return images;
}

GradientImages noisy_images(int w, int h, int channels = 3) {
  return noisy_images(
      w, h, channels, smooth_image(w, h, channels), [](size_t) { return 0.4f; }, [](size_t) { return 0.05f; });
}

std::vector<float> solve(const GradientImages& images, SolveReport* report) {
  return reconstruct(images, GRADUS_RECONSTRUCTION_WEIGHTED, 0.0f, never, report);
}

TEST(B1_FixedPoint, WeightedKeepsAnImageWithItsOwnGradients) {
  for (const auto& [w, h] : kSizes) {
    const std::vector<float> image = smooth_image(w, h, 3);
    const GradientImages images = noisy_images(
        w, h, 3, image, [](size_t) { return 0.0f; }, [](size_t) { return 0.0f; });
    SolveReport report;
    EXPECT_LT(max_difference(solve(images, &report), image), 2e-5) << w << "x" << h;
    EXPECT_FALSE(report.hit_cap);
  }
}

TEST(B2_Solver, WeightedReportsItsResidual) {
  for (const auto& [w, h] : kSizes) {
    SolveReport report;
    solve(noisy_images(w, h), &report);
    EXPECT_LE(report.residual, 1e-3f) << w << "x" << h;
    EXPECT_FALSE(report.hit_cap);
  }
}

// Half of the picture has useless differences, half has useless pixels: no single alpha serves both.
TEST(B2_Solver, WeightedGoesByTheNoiseOfEachPlace) {
  const int w = 96, h = 64;
  const std::vector<float> truth = smooth_image(w, h, 3);
  const auto left = [&](size_t i) { return int(i) % w < w / 2; };
  const GradientImages images = noisy_images(
      w, h, 3, truth, [&](size_t i) { return left(i) ? 0.01f : 1.0f; }, [&](size_t i) { return left(i) ? 1.0f : 0.01f; });
  SolveReport report;
  const double weighted = rms_difference(solve(images, &report), truth);
  for (const float alpha : {0.1f, 0.4f, 1.0f, 3.0f}) {
    const auto l2 = reconstruct(images, GRADUS_RECONSTRUCTION_L2, alpha, never, &report);
    EXPECT_LT(weighted, 0.6 * rms_difference(l2, truth)) << alpha;
  }
}

// A firefly in one half: its own deviation finds it out.
TEST(B2_Solver, WeightedIgnoresOutliersOfOneHalf) {
  const int w = 64, h = 48;
  const std::vector<float> truth = smooth_image(w, h, 3);
  GradientImages images = noisy_images(
      w, h, 3, truth, [](size_t) { return 0.1f; }, [](size_t) { return 0.01f; });
  for (const size_t pixel : {700u, 1501u, 2222u}) {
    for (int c = 0; c < 3; ++c) {
      images.primal[3 * pixel + c] += 5e3f;
      images.dy[3 * (pixel + 200) + c] -= 50.0f;
    }
    images.primal_deviation[pixel] = 5e3f;
    images.dy_deviation[pixel + 200] = 50.0f;
  }
  SolveReport report;
  const double weighted = rms_difference(solve(images, &report), truth);
  EXPECT_LT(weighted, 0.05);
  EXPECT_GT(rms_difference(reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.4f, never, &report), truth), 20 * weighted);
}

// Bright values are the noisy ones where light is rare, so weights by noise lose them; twicing gives them back.
TEST(B3_Weighted, KeepsTheMeanOfSkewedNoise) {
  const int w = 128, h = 96;
  GradientImages images = noisy_images(
      w, h, 3, std::vector<float>(size_t(w) * h * 3, 1.0f), [](size_t) { return 0.0f; }, [](size_t) { return 0.3f; });
  std::mt19937 random(1);
  for (size_t i = 0; i < images.primal_deviation.size(); ++i) {
    const auto half = [&] { return std::uniform_real_distribution<float>(0.0f, 1.0f)(random) < 0.1f ? 9.1f : 0.1f; };
    const float a = half(), b = half();
    for (int c = 0; c < 3; ++c) images.primal[3 * i + c] = 0.5f * (a + b);
    images.primal_deviation[i] = 0.5f * std::abs(a - b);
  }
  SolveReport report;
  const Minimum minimum = minimise_by_noise(images, never, &report);
  const std::vector<float> alone = make_image(w, h, 3, [&](int x, int y, int c) { return minimum.solution.row(y, c)[x]; });
  EXPECT_LT(mean(alone) / mean(images.primal), 0.9);
  EXPECT_NEAR(mean(solve(images, &report)) / mean(images.primal), 1.0, 1e-5);
}

TEST(B2_Solver, WeightedScalesWithTheImage) {
  GradientImages images = noisy_images(64, 48);
  SolveReport report;
  std::vector<float> x = solve(images, &report);
  for (auto* plane : {&images.primal, &images.dx, &images.dy, &images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) {
    for (float& v : *plane) v *= 1024.0f;
  }
  const std::vector<float> y = solve(images, &report);
  for (float& v : x) v *= 1024.0f;
  EXPECT_LT(max_difference(x, y), 1e-2 * 1024.0);
}

// One sample per pixel: a half has none, and no noise is known.
TEST(B2_Solver, WeightedWithoutKnownNoiseIsNearL2) {
  GradientImages images = noisy_images(64, 48);
  for (auto* deviation : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) {
    std::fill(deviation->begin(), deviation->end(), std::numeric_limits<float>::quiet_NaN());
  }
  SolveReport report;
  const std::vector<float> truth = smooth_image(64, 48, 3);
  const double weighted = rms_difference(solve(images, &report), truth);
  EXPECT_LT(weighted, 1.2 * rms_difference(reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.4f, never, &report), truth));
}

TEST(B2_Solver, WeightedLeavesOutWhatIsNotFinite) {
  GradientImages images = with_own_gradients(33, 17, 3, std::vector<float>(33 * 17 * 3, 1.0f));
  for (auto* deviation : {&images.primal_deviation, &images.dx_deviation, &images.dy_deviation}) deviation->assign(33 * 17, 0.1f);
  images.primal[41] = std::numeric_limits<float>::quiet_NaN();
  images.dx[90] = std::numeric_limits<float>::infinity();
  images.dy[130] = -std::numeric_limits<float>::infinity();
  SolveReport report;
  EXPECT_LT(max_difference(solve(images, &report), std::vector<float>(33 * 17 * 3, 1.0f)), 1e-3);
}

TEST(B2_Solver, WeightedOfABlackImageIsBlack) {
  SolveReport report;
  const std::vector<float> black(16 * 16 * 3, 0.0f);
  const GradientImages images = noisy_images(
      16, 16, 3, black, [](size_t) { return 0.0f; }, [](size_t) { return 0.0f; });
  EXPECT_EQ(solve(images, &report), black);
}

// Alpha goes through the weights of the colours, and the solution that comes with the weights is theirs (contract 3.4).
TEST(B2_Solver, WeightedIsALinearOperator) {
  const GradientImages images = noisy_images(48, 32, 4);
  SolveReport report;
  const auto solver = make_twiced(images, GRADUS_RECONSTRUCTION_WEIGHTED, 0.0f, never, &report);
  const std::vector<float> whole = solve(images, &report);
  std::vector<float> red(size_t(48) * 32 * 4);
  solver->apply(planes_of(images, 0), red.data());
  for (size_t i = 0; i < red.size(); i += 4) EXPECT_NEAR(whole[i], red[i], 1e-2) << i;
}

TEST(L1_Threads, WeightedHasTheSameBitsForAnyNumberOfThreads) {
  const GradientImages images = noisy_images(133, 71);
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<float> first;
  for (const int threads : {1, 2, 3, 7}) {
    SolveReport report;
    std::vector<float> x;
    tbb::task_arena(threads).execute([&] { x = solve(images, &report); });
    if (first.empty()) first = x;
    EXPECT_EQ(x, first) << threads << " threads";
  }
}

}  // namespace
}  // namespace gradus
