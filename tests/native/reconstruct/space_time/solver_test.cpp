// B1, B2, B3 for windows.
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "base/error.h"
#include "reconstruct/field_values.h"
#include "reconstruct/space_time/sequences.h"
#include "reconstruct/space_time/share_smoothing.h"
#include "reconstruct/space_time/window_solver.h"
#include "support/threads.h"

namespace gradus::solver_test {
namespace {

using namespace test;

constexpr uint32_t kL2 = GRADUS_RECONSTRUCTION_L2, kL1 = GRADUS_RECONSTRUCTION_L1;
constexpr uint32_t kAll[] = {kL2, kL1};

reconstruct::WindowSolver solver_of(const reconstruct::WindowSource& window, uint32_t reconstruction,
                                    float alpha = 0.0f) {
  reconstruct::SolveReport report;
  reconstruct::WindowSolver solver(window, reconstruction, alpha, never, &report);
  EXPECT_FALSE(report.hit_cap);
  return solver;
}
std::vector<float> solve(const reconstruct::WindowSource& window, uint32_t reconstruction, float alpha = 0.0f) {
  return joined(solver_of(window, reconstruction, alpha).solution());
}

Window noisy_window(int width, int height, int channels, int frames, Motion motion) {
  Window window = measured(width, height, channels, frames, motion);
  add_noise_of_halves(
      &window, [](reconstruct::RowKind kind, size_t) { return kind == reconstruct::RowKind::kPrimal ? 0.4f : 0.05f; },
      1);
  return window;
}

TEST(B1_SpaceTime, ASequenceWithItsOwnDifferencesIsKept) {
  for (const Motion motion : kMotions) {
    for (const uint32_t reconstruction : kAll) {
      const Window window = measured(33, 17, 3, 6, motion);
      const Images images = changing_images(window.size_);
      EXPECT_LT(max_difference(solve(window, reconstruction), joined(images)), 2e-3)
          << int(motion) << " by " << reconstruction;
    }
  }
}

TEST(B2_SpaceTime, AnySizeIsSolved) {
  for (const auto& [w, h] : {std::pair(1, 1), std::pair(1, 7), std::pair(7, 1), std::pair(2, 3), std::pair(64, 33)}) {
    for (const int frames : {1, 2, 10}) {
      for (const uint32_t reconstruction : kAll) {
        const Window window = measured(w, h, 3, frames, Motion::kStatic);
        EXPECT_LT(max_difference(solve(window, reconstruction), joined(changing_images(window.size_))), 2e-3)
            << w << "x" << h << "x" << frames << " by " << reconstruction;
      }
    }
  }
}

// Frames without correspondences are single frames.
TEST(B2_SpaceTime, WithoutCorrespondencesL2IsThatOfSingleFrames) {
  const Window window = noisy_window(96, 64, 3, 3, Motion::kNone);
  const reconstruct::Frames x = solver_of(window, kL2).take_solution();
  for (int t = 0; t < 3; ++t) {
    reconstruct::SolveReport report;
    EXPECT_LT(max_difference(reconstruct::interleave(x[size_t(t)]),
                             reconstruct::reconstruct(frame_of(window, t), kL2, 0.0f, never, &report)),
              5e-5);
  }
}

// Weights have 16 bits, which is the only difference.
TEST(B2_SpaceTime, WithoutCorrespondencesWeightsAreThoseOfSingleFrames) {
  const Window window = noisy_window(96, 64, 3, 3, Motion::kNone);
  const reconstruct::Frames x = solver_of(window, kL1).take_solution();
  for (int t = 0; t < 3; ++t) {
    reconstruct::SolveReport report;
    const std::vector<float> still = reconstruct::reconstruct(frame_of(window, t), kL1, 0.0f, never, &report);
    const std::vector<float> l2 = reconstruct::reconstruct(frame_of(window, t), kL2, 0.0f, never, &report);
    const double difference = rms_difference(reconstruct::interleave(x[size_t(t)]), still);
    EXPECT_LT(difference, 0.02 * rms_difference(l2, still));
  }
}

TEST(B2_SpaceTime, L2KeepsTheMean) {
  for (const Motion motion : kMotions) {
    const Window window = noisy_window(64, 48, 1, 5, motion);
    Images primal;
    for (int t = 0; t < 5; ++t) primal.push_back(window.plane(reconstruct::RowKind::kPrimal, t));
    EXPECT_NEAR(mean(solve(window, kL2)) / mean(joined(primal)), 1.0, 1e-5) << int(motion);
  }
}

// Returns the mean squared error of L2, by the modes of the system of a static window (T-GPT eq. 4, with free ends):
// noise of deviation σ_I in pixels, σ_g in differences in space, none along correspondences.
double remaining_noise(int w, int h, int frames, double alpha, double sigma_i, double sigma_g) {
  const auto eigenvalue = [](int k, int n) { return 2.0 - 2.0 * std::cos(std::numbers::pi * k / n); };
  double sum = 0.0;
  for (int k = 0; k < frames; ++k) {
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const double space = eigenvalue(x, w) + eigenvalue(y, h), time = eigenvalue(k, frames);
        const double a = alpha * alpha + space + time + space * time;
        sum += (std::pow(alpha, 4) * sigma_i * sigma_i + sigma_g * sigma_g * space) / (a * a);
      }
    }
  }
  return sum / (double(frames) * w * h);
}

// A static shot: the same random numbers give the same picture, so that differences in time are known to be 0.
TEST(B3_SpaceTime, AStaticShotHasTheNoiseThatTheoryPredicts) {
  constexpr int w = 24, h = 18, runs = 24;
  for (const int frames : {1, 2, 5, 10}) {
    double squares = 0.0;
    for (unsigned run = 0; run < runs; ++run) {
      Window window(w, h, 3, frames);
      set_correspondences(&window, Motion::kStatic);
      for (int t = 0; t < frames; ++t) {
        add_noise(&window.plane(reconstruct::RowKind::kPrimal, t), 1.0f, 100 * run + unsigned(t));
        add_noise(&window.plane(reconstruct::RowKind::kDx, t), 0.2f, 100 * run + 20 + unsigned(t));
        add_noise(&window.plane(reconstruct::RowKind::kDy, t), 0.2f, 100 * run + 40 + unsigned(t));
      }
      const std::vector<float> x = solve(window, kL2, 0.4f);
      squares += std::pow(rms_difference(x, std::vector<float>(x.size(), 0.0f)), 2) / runs;
    }
    const double expected = remaining_noise(w, h, frames, 0.4, 1.0, 0.2);
    std::printf("  %d frames: %.5f, expected %.5f\n", frames, squares, expected);
    EXPECT_NEAR(squares / expected, 1.0, 0.06) << frames;
  }
}

// z-test of every pixel over runs with skewed noise in all rows.
TEST(B3_SpaceTime, L2IsUnbiased) {
  constexpr int w = 9, h = 7, frames = 4, runs = 600;
  const Window exact = measured(w, h, 1, frames, Motion::kTurn);
  const std::vector<float> truth = joined(changing_images(exact.size_));
  std::vector<double> sum(truth.size()), squares(truth.size());
  std::mt19937 random(5);
  std::exponential_distribution<float> exponential(1.0f);
  for (int run = 0; run < runs; ++run) {
    Window window = exact;
    for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
      const float sigma = kind == reconstruct::RowKind::kPrimal ? 1.0f : 0.3f;
      for (auto& plane : window.planes[size_t(kind)]) {
        for (float& v : plane) v += sigma * (exponential(random) - 1.0f);
      }
    }
    const std::vector<float> x = solve(window, kL2);
    for (size_t i = 0; i < x.size(); ++i) {
      const double error = double(x[i]) - truth[i];
      sum[i] += error;
      squares[i] += error * error;
    }
  }
  double mean_square = 0.0, worst = 0.0;
  for (size_t i = 0; i < sum.size(); ++i) {
    const double variance = (squares[i] - sum[i] * sum[i] / runs) / (runs - 1), z = sum[i] / std::sqrt(variance * runs);
    mean_square += z * z / double(sum.size());
    worst = std::max(worst, std::abs(z));
  }
  // Errors of neighbours are correlated: about 30 of 252 are independent.
  EXPECT_LT(mean_square, 1.8);
  EXPECT_GT(mean_square, 0.4);
  EXPECT_LT(worst, 4.2);
}

// A source with a part or an affine function of the first three channels: a component of an image, or its alpha.
Window share_of(const Window& window, float share, float offset) {
  Window part = window;
  for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
    for (auto& plane : part.planes[size_t(kind)]) {
      for (float& v : plane) v = share * v + (kind == reconstruct::RowKind::kPrimal ? offset : 0.0f);
    }
  }
  return part;
}

TEST(B2_SpaceTime, FrozenWeightsAreALinearOperator) {
  for (const uint32_t reconstruction : kAll) {
    const Window window = noisy_window(64, 48, 3, 5, Motion::kTurn);
    const reconstruct::WindowSolver solver = solver_of(window, reconstruction);
    reconstruct::SolveReport report;
    const auto apply = [&](const Window& planes) { return joined(solver.apply(planes, 0, 3, never, &report)); };
    const std::vector<float> whole = joined(solver.solution());
    EXPECT_LT(rms_difference(apply(window), whole), 2e-3) << reconstruction;
    std::vector<float> sum = apply(share_of(window, 0.3f, 0.2f));
    const std::vector<float> rest = apply(share_of(window, 0.7f, -0.2f));
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += rest[i];
    EXPECT_LT(max_difference(sum, apply(window)), 1e-3) << reconstruction;
  }
}

TEST(B2_SpaceTime, AConstantIsKeptByWeightsOfOtherPlanes) {
  for (const uint32_t reconstruction : kAll) {
    const reconstruct::WindowSolver solver = solver_of(noisy_window(64, 48, 3, 5, Motion::kTurn), reconstruction);
    Window flat = measured(64, 48, 1, 5, Motion::kTurn);
    flat.measure(Images(5, std::vector<float>(64 * 48, 0.75f)));
    reconstruct::SolveReport report;
    for (const float v : joined(solver.apply(flat, 0, 1, never, &report)))
      ASSERT_NEAR(v, 0.75f, 1e-3f) << reconstruction;
  }
}

TEST(L1_Threads, WindowsHaveTheSameBitsForAnyNumberOfThreads) {
  const Window window = noisy_window(133, 71, 3, 4, Motion::kTurn);
  for (const uint32_t reconstruction : kAll) {
    expect_same_bits_for_any_number_of_threads([&] { return solve(window, reconstruction); });
  }
}

double error_of(const Window& window, uint32_t reconstruction, const Images& truth) {
  return rms_difference(solve(window, reconstruction), joined(truth));
}

TEST(B2_SpaceTime, L1IgnoresOutliersAlongCorrespondences) {
  Window window = measured(64, 48, 3, 5, Motion::kStatic);
  const Images truth = changing_images(window.size_);
  add_noise_of_halves(
      &window, [](reconstruct::RowKind kind, size_t) { return kind == reconstruct::RowKind::kPrimal ? 0.1f : 0.02f; },
      1);
  for (size_t i = 100; i < 64 * 48 * 3; i += 301) {
    window.plane(reconstruct::RowKind::kDt, 2)[i] += 30.0f;
    window.plane(reconstruct::RowKind::kDxDt, 1)[i] -= 30.0f;
    window.plane(reconstruct::RowKind::kDyDt, 3)[i] -= 30.0f;
  }
  EXPECT_LT(error_of(window, kL1, truth), 0.06);
  EXPECT_GT(error_of(window, kL2, truth), 0.15);
}

// If light is rare, bright values have more noise, so that weights by noise lose them. Twicing restores them, and no
// frame flickers more than its noise.
TEST(B3_SpaceTime, WeightsKeepTheMeanOfSkewedNoise) {
  Window window(96, 64, 3, 5);
  set_correspondences(&window, Motion::kStatic);
  window.measure(Images(5, std::vector<float>(96 * 64 * 3, 1.0f)));
  add_noise_of_halves(
      &window,
      [](reconstruct::RowKind kind, size_t) {
        return kind == reconstruct::RowKind::kPrimal || reconstruct::is_temporal(kind) ? 0.0f : 0.3f;
      },
      1);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform;
  Images primal;
  for (int t = 0; t < 5; ++t) {
    for (size_t i = 0; i < 96 * 64; ++i) {
      const float a = uniform(random) < 0.1f ? 9.1f : 0.1f, b = uniform(random) < 0.1f ? 9.1f : 0.1f;
      for (size_t c = 0; c < 3; ++c) window.plane(reconstruct::RowKind::kPrimal, t)[3 * i + c] = 0.5f * (a + b);
      window.deviations[0][size_t(t)][i] = 0.5f * std::abs(a - b);
    }
    primal.push_back(window.plane(reconstruct::RowKind::kPrimal, t));
  }
  EXPECT_NEAR(mean(solve(window, kL1)) / mean(joined(primal)), 1.0, 1e-3);
}

// A missing row does not exist: its values do not matter.
TEST(B2_SpaceTime, MissingRowsAreLeftOut) {
  Window window = measured(33, 17, 3, 4, Motion::kTurn);
  for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
    for (size_t i = 3; i < 33 * 17 * 3; i += 37) window.plane(kind, 1)[i] = std::numeric_limits<float>::quiet_NaN();
  }
  for (const uint32_t reconstruction : kAll) {
    const double worst = max_difference(solve(window, reconstruction), joined(changing_images(window.size_)));
    EXPECT_LT(worst, 1e-3) << reconstruction;
  }
}

// Smoothing random values that are shares of light keeps their sums along tracks, and shares that are the same
// everywhere.
TEST(B2_SpaceTime, SmoothingOfSharesKeepsSumsAndShares) {
  constexpr int w = 13, h = 9, frames = 5;
  const reconstruct::SpaceTimeSystem system(measured(w, h, 1, frames, Motion::kTurn));
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  reconstruct::ShareSmoothing smoothing;
  reconstruct::Frames values = system.make_fields(2);
  double sum = 0.0, kept = 0.0;
  for (int t = 0; t < frames; ++t) {
    reconstruct::Field light = reconstruct::make_field(w, h, [&](int, int) { return std::exp(normal(random)); });
    for_values(&values[size_t(t)],
               [&](float& value, int x, int y, int c) { value = c == 0 ? normal(random) : 0.3f * light.row(y)[x]; });
    sum += sum_rows(h, 1, [&](int y, int) {
      return std::accumulate(values[size_t(t)].row(y), values[size_t(t)].row(y) + w, 0.0);
    })[0];
    smoothing.add_frame(std::move(light), t > 0 ? &system.correspondence(t - 1) : nullptr);
  }
  const reconstruct::Frames before = values;
  smoothing.apply(system, 0.04f, &values);
  float moved = 0.0f;
  for (size_t t = 0; t < frames; ++t) {
    for_values(&values[t], [&](float& value, int x, int y, int c) {
      const float was = before[t].row(y, c)[x];
      if (c == 1) {
        EXPECT_NEAR(value / was, 1.0f, 0.01f);
      } else {
        kept += value;
        moved = std::max(moved, std::fabs(value - was));
      }
    });
  }
  EXPECT_NEAR(kept, sum, 1e-3);
  EXPECT_GT(moved, 0.5f) << "nothing moves, so that the test shows nothing";
}

TEST(B2_SpaceTime, CorrespondencesThatAreNotOneToOneAreRefused) {
  Window window = measured(8, 8, 1, 2, Motion::kStatic);
  window.correspondence[0][3] = 4;
  EXPECT_THROW(reconstruct::SpaceTimeSystem{window}, Error);
  window.correspondence[0][3] = 64;
  EXPECT_THROW(reconstruct::SpaceTimeSystem{window}, Error);
  window.correspondence[0][3] = film::kNoCorrespondence;
  EXPECT_NO_THROW(reconstruct::SpaceTimeSystem{window});
}

TEST(K2_Cancel, WindowsEndAtOnce) {
  const Window window = noisy_window(64, 48, 3, 4, Motion::kStatic);
  for (const uint32_t reconstruction : kAll) {
    reconstruct::SolveReport report;
    const reconstruct::WindowSolver solver(
        window, reconstruction, 0.0f, [] { return true; }, &report);
    EXPECT_EQ(report.inner_steps, 0) << reconstruction;
  }
}

}  // namespace
}  // namespace gradus::solver_test
