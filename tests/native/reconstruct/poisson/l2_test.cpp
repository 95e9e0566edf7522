// B1, B2: the exact L2 solver against its definition, in double.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "base/error.h"
#include "reconstruct/poisson/l2.h"
#include "reconstruct/test_images.h"
#include "schema/options.h"
#include "support/threads.h"

namespace gradus::l2_test {
namespace {

using namespace test;

struct Size {
  int width, height;
};

constexpr Size kSizes[] = {{1, 1}, {1, 7}, {7, 1}, {2, 2}, {33, 17}, {64, 48}, {512, 512}};

// Returns ‖A x − b‖ / ‖b‖ with A = α² + DᵀD and b = α²I + Dᵀg, for one channel.
double residual(const film::GradientImages& images, const std::vector<float>& x, double alpha) {
  const int w = images.width, h = images.height;
  const auto at = [w](const std::vector<float>& v, int px, int py) { return double(v[size_t(py) * w + px]); };
  double error = 0.0, norm = 0.0;
  for (int py = 0; py < h; ++py) {
    for (int px = 0; px < w; ++px) {
      double b = alpha * alpha * at(images.primal, px, py), a = alpha * alpha * at(x, px, py);
      if (px + 1 < w) {
        b -= at(images.dx, px, py);
        a -= at(x, px + 1, py) - at(x, px, py);
      }
      if (px > 0) {
        b += at(images.dx, px - 1, py);
        a += at(x, px, py) - at(x, px - 1, py);
      }
      if (py + 1 < h) {
        b -= at(images.dy, px, py);
        a -= at(x, px, py + 1) - at(x, px, py);
      }
      if (py > 0) {
        b += at(images.dy, px, py - 1);
        a += at(x, px, py) - at(x, px, py - 1);
      }
      error += (a - b) * (a - b);
      norm += b * b;
    }
  }
  return norm > 0.0 ? std::sqrt(error / norm) : std::sqrt(error);
}

std::vector<float> solve(const film::GradientImages& images, float alpha = 0.2f) {
  reconstruct::SolveReport report;
  return reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, alpha, never, &report);
}

TEST(B1_FixedPoint, L2KeepsAnImageWithItsOwnGradients) {
  for (const Size s : kSizes) {
    const std::vector<float> image = smooth_image(s.width, s.height, 3);
    const std::vector<float> result = solve(with_exact_gradients(s.width, s.height, 3, image));
    EXPECT_LT(max_difference(result, image), 1e-5) << s.width << "x" << s.height;
  }
}

TEST(B1_FixedPoint, L2KeepsAConstant) {
  const std::vector<float> image(33 * 17 * 3, 0.75f);
  EXPECT_LT(max_difference(solve(with_exact_gradients(33, 17, 3, image)), image), 1e-6);
}

// The weight 0 selects the automatic weight. A true weight of 0 would leave the brightness of the image undefined.
TEST(B2_Solver, AutomaticWeightIsThatOfTheSolver) {
  film::GradientImages images = with_exact_gradients(33, 17, 3, smooth_image(33, 17, 3));
  add_noise(&images.dx, 0.05f, 2);
  EXPECT_EQ(solve(images, 0.0f), solve(images, 0.4f));
  reconstruct::SolveReport report;
  const auto l1 = [&](float alpha) {
    return reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L1, alpha, never, &report);
  };
  EXPECT_EQ(l1(0.0f), l1(0.2f));
}

TEST(B2_Solver, TooSmallAWeightIsRefused) {
  EXPECT_NO_THROW(schema::check_alpha(0.0f));
  EXPECT_NO_THROW(schema::check_alpha(1e-3f));
  EXPECT_THROW(schema::check_alpha(5e-4f), Error);
  EXPECT_THROW(schema::check_alpha(std::numeric_limits<float>::quiet_NaN()), Error);
}

TEST(B2_Solver, L2SolvesTheNormalEquations) {
  for (const Size s : kSizes) {
    for (const float alpha : {0.02f, 0.2f, 1.0f}) {
      film::GradientImages images = with_exact_gradients(s.width, s.height, 1, smooth_image(s.width, s.height, 1));
      add_noise(&images.primal, 0.3f, 1);
      add_noise(&images.dx, 0.05f, 2);
      add_noise(&images.dy, 0.05f, 3);
      // The rows at the border exist in memory, but not in the system: their values must not matter.
      const std::vector<float> x = solve(images, alpha);
      EXPECT_LT(residual(images, x, alpha), 1e-4) << s.width << "x" << s.height << " alpha " << alpha;
      EXPECT_NEAR(mean(x), mean(images.primal), 1e-5 * std::abs(mean(images.primal)) + 1e-7);
    }
  }
}

// Regression: sums over a row or column of large values overflowed.
TEST(B2_Solver, L2OfHugeValuesIsFinite) {
  const std::vector<float> image = make_image(256, 256, 1, [](int x, int, int) { return x < 128 ? 2e37f : 1e37f; });
  const std::vector<float> x = solve(with_exact_gradients(256, 256, 1, image), 0.4f);
  for (size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i] / image[i], 1.0f, 1e-4f);
}

TEST(B2_Solver, L2OfASpikeKeepsItsMean) {
  for (const Size s : kSizes) {
    film::GradientImages images =
        with_exact_gradients(s.width, s.height, 1, std::vector<float>(size_t(s.width) * s.height, 0.5f));
    images.primal[images.primal.size() / 2] = 1e6f;
    const std::vector<float> x = solve(images);
    EXPECT_LT(residual(images, x, 0.2), 1e-4);
    EXPECT_NEAR(mean(x) / mean(images.primal), 1.0, 1e-5) << s.width << "x" << s.height;
  }
}

TEST(B2_Solver, L2OfAStepAndAPlane) {
  const auto step = make_image(64, 48, 1, [](int x, int, int) { return x < 30 ? 0.0f : 1000.0f; });
  EXPECT_LT(max_difference(solve(with_exact_gradients(64, 48, 1, step)), step), 1e-2);
  const auto plane = make_image(64, 48, 1, [](int x, int y, int) { return 0.5f * float(x) - 0.25f * float(y); });
  EXPECT_LT(max_difference(solve(with_exact_gradients(64, 48, 1, plane)), plane), 1e-4);
}

TEST(B2_Solver, L2LeavesOutValuesThatAreNotFinite) {
  film::GradientImages images = with_exact_gradients(33, 17, 1, std::vector<float>(33 * 17, 1.0f));
  images.primal[40] = std::numeric_limits<float>::quiet_NaN();
  images.dx[90] = std::numeric_limits<float>::infinity();
  for (const float v : solve(images)) EXPECT_TRUE(std::isfinite(v));
}

TEST(L1_Threads, L2HasTheSameBitsForAnyNumberOfThreads) {
  film::GradientImages images = with_exact_gradients(133, 71, 3, smooth_image(133, 71, 3));
  add_noise(&images.primal, 0.3f, 1);
  test::expect_same_bits_for_any_number_of_threads([&] { return solve(images); });
}

// L2 is a linear operator: the solution of a sum is the sum of the solutions.
TEST(B2_Solver, L2IsLinear) {
  film::GradientImages a = with_exact_gradients(33, 17, 1, smooth_image(33, 17, 1)), b = a;
  add_noise(&a.primal, 0.3f, 1);
  add_noise(&b.dx, 0.3f, 2);
  film::GradientImages sum = a;
  for (size_t i = 0; i < sum.primal.size(); ++i) {
    sum.primal[i] += b.primal[i];
    sum.dx[i] += b.dx[i];
    sum.dy[i] += b.dy[i];
  }
  std::vector<float> x = solve(a);
  const std::vector<float> y = solve(b);
  for (size_t i = 0; i < x.size(); ++i) x[i] += y[i];
  EXPECT_LT(max_difference(x, solve(sum)), 1e-5);
}

// Pairs without samples give no rows: a column of them separates two independent pictures.
TEST(B2_Solver, L2LeavesOutPairsWithoutSamples) {
  const int w = 40, h = 24, left = 17;
  film::GradientImages images = with_exact_gradients(w, h, 3, smooth_image(w, h, 3));
  add_noise(&images.primal, 0.3f, 1);
  add_noise(&images.dx, 0.1f, 2);
  const auto part = [&](int begin, int width) {
    const auto cut = [&](const std::vector<float>& from) {
      return make_image(width, h, 3,
                        [&](int x, int y, int c) { return from[3 * (size_t(y) * w + size_t(begin + x)) + c]; });
    };
    film::GradientImages result = images;
    result.width = width;
    result.primal = cut(images.primal);
    result.dx = cut(images.dx);
    result.dy = cut(images.dy);
    return solve(result);
  };
  const std::vector<float> a = part(0, left), b = part(left, w - left);
  for (int y = 0; y < h; ++y) {
    for (int c = 0; c < 3; ++c) images.dx[3 * (size_t(y) * w + left - 1) + c] = film::kAbsentPair;
  }
  const std::vector<float> x = solve(images);
  for (int y = 0; y < h; ++y) {
    for (int px = 0; px < w; ++px) {
      const float expected = px < left ? a[3 * (size_t(y) * left + px)] : b[3 * (size_t(y) * (w - left) + px - left)];
      ASSERT_NEAR(x[3 * (size_t(y) * w + px)], expected, 1e-4f) << px << ", " << y;
    }
  }
}

// Returns sums of noise; some pixels have no samples.
film::Film noisy_film(int width, int height, int channels) {
  film::Film film(uint32_t(width), uint32_t(height), {0, 0, width, height}, channels, 1, true);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::uniform_int_distribution<uint32_t> samples(0, 3), pairs(1, 3);
  const auto fill = [&](std::vector<Radiance>* plane) {
    for (Radiance& value : *plane) value = {normal(random), normal(random), normal(random), normal(random)};
  };
  for (int h = 0; h < film::kHalves; ++h) {
    fill(&film.components[0].primal[h]);
    for (uint32_t& count : film.count[h]) count = samples(random);
    for (int offset = 0; offset < film::kOffsets; ++offset) {
      fill(&film.components[0].gradient[h][offset]);
      for (float& count : film.pair_count[h][offset]) count = static_cast<float>(pairs(random));
    }
  }
  return film;
}

// The rows of a film are read when they are needed, and its channels are solved together.
TEST(B2_Solver, L2OfAFilmHasTheBitsOfItsImagesChannelByChannel) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  for (const Size s : kSizes) {
    for (const int channels : {3, 4}) {
      const film::Film film = noisy_film(s.width, s.height, channels);
      const film::GradientImages images = film::read_images(film, 0);
      std::vector<float> expected(images.primal.size());
      for (int c = 0; c < channels; ++c) {
        const auto rows = reconstruct::rows_of(reconstruct::planes_of(images, c), s.width, 1);
        const auto alone = reconstruct::solve_l2(s.width, s.height, 1, 0.2f, rows);
        ASSERT_TRUE(alone);
        for (size_t i = 0; i < alone->size(); ++i) expected[i * size_t(channels) + size_t(c)] = (*alone)[i];
      }
      EXPECT_EQ(solve(images), expected);
      for (const int threads : {1, 3}) {
        reconstruct::SolveReport report;
        std::vector<float> x;
        tbb::task_arena(threads).execute(
            [&] { x = reconstruct::reconstruct(film, 0, GRADUS_RECONSTRUCTION_L2, 0.2f, never, &report); });
        EXPECT_EQ(x, expected) << s.width << "x" << s.height << ", " << threads << " threads";
      }
    }
  }
}

}  // namespace
}  // namespace gradus::l2_test
