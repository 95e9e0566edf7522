// What stops cells is the same estimate that the pass Error shows.
#include "render/cell_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reconstruct/feature_frame.h"
#include "reconstruct/reconstruct_frame.h"

namespace gradus {
namespace {

const CancelTest kNever = [] { return false; };
constexpr float kExposure = 2.0f;

Frame noisy_room(bool gradients) {
  test::FeatureFrame description = test::room(40, 32);
  description.gradients = gradients;
  Frame frame = test::make_feature_frame(description);
  frame.settings.film_exposure = kExposure;
  return frame;
}

// Root of mean squared error over mean squared gray, by the estimate's sum over the cell.
double relative_error(const Frame& frame, const Reconstructed& result, const Region& cell, double error) {
  double signal = 0.0;
  for (int32_t y = cell.y0; y < cell.y1; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) {
      const float* v = &result.image[3 * frame.index(x, y)];
      const double gray = kExposure * (double(v[0]) + v[1] + v[2]) / 3.0;
      signal += gray * gray + 1e-3;
    }
  }
  return std::sqrt(kExposure * kExposure * error / signal);
}

double sum_over(const Frame& frame, const std::vector<float>& pixels, const Region& cell) {
  double sum = 0.0;
  for (int32_t y = cell.y0; y < cell.y1; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) sum += pixels[frame.index(x, y)];
  }
  return sum;
}

// Noise of the halves, which a reconstruction by features hides, says nothing of its error: its own estimate has to be taken.
TEST(CellNoise, OfAReconstructionThatEstimatesItsErrorIsThatEstimate) {
  for (const bool gradients : {false, true}) {
    const Frame frame = noisy_room(gradients);
    SolveReport report;
    const Reconstructed result = reconstruct_frame(frame, GRADUS_RECONSTRUCTION_REGULARIZED, 0.0f, {.error = true}, kNever, &report);
    const std::vector<Region> cells = {{0, 0, 16, 16}, {16, 0, 40, 32}};
    const std::vector<CellNoise> noise = estimate_noise(frame, cells, GRADUS_RECONSTRUCTION_REGULARIZED, 0.0f, kNever);
    ASSERT_EQ(noise.size(), cells.size());
    for (size_t k = 0; k < cells.size(); ++k) {
      const double error = sum_over(frame, result.error, cells[k]);
      ASSERT_GT(error, 0.0);
      EXPECT_NEAR(noise[k].relative_error / relative_error(frame, result, cells[k], error), 1.0, 1e-5);
      EXPECT_GT(noise[k].spread, 0.0);
    }
  }
}

// The whole picture as one cell: what the windows of the pass spread stays in it, but for what the border cuts off.
TEST(CellNoise, OfAllIsTheSumOfThePass) {
  const Frame frame = noisy_room(true);
  for (const uint32_t how : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2}) {
    SolveReport report;
    const Reconstructed result = reconstruct_frame(frame, how, 0.0f, {.error = true}, kNever, &report);
    const CellNoise noise = estimate_noise(frame, {frame.region}, how, 0.0f, kNever).front();
    const double error = sum_over(frame, result.error, frame.region);
    EXPECT_NEAR(noise.relative_error / relative_error(frame, result, frame.region, error), 1.0, 0.02) << how;
  }
}

}  // namespace
}  // namespace gradus
