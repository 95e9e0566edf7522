// The loop with a noise threshold: samples go where the noise is.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "render/fake_integrator.h"

namespace gradus {
namespace {

using namespace test;

constexpr int kWidth = 140, kHeight = 70, kQuiet = 64;  // cells are cut at two sides

// A threshold that nothing meets.
GradusSettings adaptive_settings(uint32_t samples, float threshold = 1e-6f) {
  GradusSettings settings = small_settings(kWidth, kHeight, samples);
  settings.noise_threshold = threshold;
  return settings;
}

IntegratorFactory quiet_at_the_left() {
  return fake_factory([](FakeIntegrator* fake) { fake->quiet_until = kQuiet; });
}

std::shared_ptr<const Frame> render_frame(const GradusSettings& settings, std::shared_ptr<const Frame> resumed = nullptr) {
  const auto render = start(settings, quiet_at_the_left(), std::move(resumed));
  render->wait(-1.0);
  return render->frame();
}

double mean_count(const Frame& frame, int x0, int x1) {
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = x0; x < x1; ++x) sum += frame.count[0][frame.index(x, y)] + frame.count[1][frame.index(x, y)];
  }
  return sum / double(kHeight * (x1 - x0));
}

double squared_error(const GradusSettings& settings) {
  const auto render = start(settings, quiet_at_the_left());
  render->wait(-1.0);
  const auto image = read(*render, GRADUS_PASS_NOISY_IMAGE, {0, 0, kWidth, kHeight});
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double e = image[4 * size_t(y * kWidth + x)] / fake_truth(x, y) - 1.0;
      sum += e * e;
    }
  }
  return sum;
}

TEST(Adaptive, NoisyCellsTakeMoreOfTheSameNumberOfSamples) {
  GradusSettings settings = adaptive_settings(64);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  const auto frame = render_frame(settings);
  EXPECT_NEAR(mean_count(*frame, 0, kWidth), 64.0, 0.2);
  EXPECT_LT(mean_count(*frame, 0, kQuiet - 16), 40.0);
  EXPECT_GT(mean_count(*frame, kQuiet + 16, kWidth), 75.0);
  const double shared = squared_error(settings);
  settings.noise_threshold = 0.0f;
  EXPECT_LT(shared, 0.8 * squared_error(settings));
}

TEST(Adaptive, SamplesOfAPixelAreNumberedWithoutGaps) {
  GradusSettings settings = adaptive_settings(48);
  settings.first_sample = 5;
  const auto frame = render_frame(settings);
  FakeIntegrator fake(IntegratorContext{nullptr, {}, settings}, false);
  fake.quiet_until = kQuiet;
  for (int y = 0; y < kHeight; y += 3) {
    for (int x = 0; x < kWidth; x += 3) {
      const size_t i = frame->index(x, y);
      float sum[kHalves] = {};
      for (uint32_t s = 5; s < 5 + frame->count[0][i] + frame->count[1][i]; ++s) sum[s % 2] += fake.value_of(x, y, s);
      ASSERT_EQ(frame->components[0].primal[0][i].x, sum[0]) << x << " " << y;
      ASSERT_EQ(frame->components[0].primal[1][i].x, sum[1]) << x << " " << y;
    }
  }
  uint32_t most = 0;
  for (size_t i = 0; i < frame->count[0].size(); ++i) most = std::max(most, frame->count[0][i] + frame->count[1][i]);
  EXPECT_EQ(frame->samples.list(), (std::vector<SampleRange>{{5, 5 + most}}));
}

TEST(L1_Threads, AdaptiveSamplesHaveTheSameBitsForAnyNumberOfThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 8);
  std::shared_ptr<const Frame> first;
  for (const uint32_t threads : {1u, 2u, 3u, 7u}) {
    GradusSettings settings = adaptive_settings(64, 0.02f);
    settings.threads = threads;
    const auto frame = render_frame(settings);
    if (!first) first = frame;
    EXPECT_TRUE(same_samples(*frame, *first)) << threads;
  }
  EXPECT_NE(mean_count(*first, 0, kQuiet), mean_count(*first, kQuiet, kWidth));
}

// Cells were judged at the end of a batch, which a render that went on from 16 samples had not seen.
TEST(L3_Resume, AdaptiveRendersGoOnWithTheSameBits) {
  const auto whole = render_frame(adaptive_settings(64));
  EXPECT_TRUE(same_samples(*whole, *render_frame(adaptive_settings(64), render_frame(adaptive_settings(16)))));
}

// All cells share what is left where others are done: no more than the batch would take of them.
TEST(Adaptive, SamplesThatCellsLeaveAreSaved) {
  const auto frame = render_frame(adaptive_settings(256, 0.06f));
  EXPECT_EQ(mean_count(*frame, 0, 16), 16.0);
  EXPECT_LT(mean_count(*frame, 0, kWidth), 200.0);
}

}  // namespace
}  // namespace gradus
