// The loop with a noise threshold: more samples are taken where the noise is high.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "film_io/store.h"
#include "render/fake_integrator.h"
#include "render/resume.h"

namespace gradus::adaptive_test {
namespace {

using namespace test;

constexpr int kWidth = 140, kHeight = 70, kQuiet = 64;  // blocks are cropped at two sides

// Returns settings with a threshold that is never reached.
GradusSettings adaptive_settings(uint32_t samples, float threshold = 1e-6f) {
  GradusSettings settings = small_settings(kWidth, kHeight, samples);
  settings.noise_threshold = threshold;
  return settings;
}

render::IntegratorFactory quiet_at_the_left() {
  return fake_factory([](FakeIntegrator* fake) { fake->quiet_until = kQuiet; });
}

std::shared_ptr<const film::Film> render_film(const GradusSettings& settings,
                                              std::shared_ptr<const film::Film> resumed = nullptr) {
  const auto render = start(settings, quiet_at_the_left(), std::move(resumed));
  render->wait(-1.0);
  return render->film();
}

double mean_count(const film::Film& film, int x0, int x1) {
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = x0; x < x1; ++x) sum += film::samples_at(film, film.index(x, y));
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

TEST(Adaptive, NoisyBlocksTakeMoreOfTheSameNumberOfSamples) {
  GradusSettings settings = adaptive_settings(64);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  const auto film = render_film(settings);
  EXPECT_NEAR(mean_count(*film, 0, kWidth), 64.0, 0.2);
  EXPECT_LT(mean_count(*film, 0, kQuiet - 16), 40.0);
  EXPECT_GT(mean_count(*film, kQuiet + 16, kWidth), 75.0);
  const double shared = squared_error(settings);
  settings.noise_threshold = 0.0f;
  EXPECT_LT(shared, 0.8 * squared_error(settings));
}

TEST(Adaptive, SamplesOfAPixelAreNumberedWithoutGaps) {
  GradusSettings settings = adaptive_settings(48);
  settings.first_sample = 5;
  const auto film = render_film(settings);
  FakeIntegrator fake(integrator::IntegratorContext{nullptr, {}, settings}, false);
  fake.quiet_until = kQuiet;
  for (int y = 0; y < kHeight; y += 3) {
    for (int x = 0; x < kWidth; x += 3) {
      const size_t i = film->index(x, y);
      float sum[film::kHalves] = {};
      for (uint32_t s = 5; s < 5 + film::samples_at(*film, i); ++s) sum[s % 2] += fake.value_of(x, y, s);
      ASSERT_EQ(film->components[0].primal[0][i].x, sum[0]) << x << " " << y;
      ASSERT_EQ(film->components[0].primal[1][i].x, sum[1]) << x << " " << y;
    }
  }
  uint32_t maximum = 0;
  for (size_t i = 0; i < film->count[0].size(); ++i) maximum = std::max(maximum, film::samples_at(*film, i));
  EXPECT_EQ(film->samples.list(), (std::vector<film::SampleRange>{{5, 5 + maximum}}));
}

TEST(L1_Threads, AdaptiveSamplesHaveTheSameBitsForAnyNumberOfThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 8);
  std::shared_ptr<const film::Film> first;
  for (const uint32_t threads : {1u, 2u, 3u, 7u}) {
    GradusSettings settings = adaptive_settings(64, 0.02f);
    settings.threads = threads;
    const auto film = render_film(settings);
    if (!first) first = film;
    EXPECT_TRUE(same_samples(*film, *first)) << threads;
  }
  EXPECT_NE(mean_count(*first, 0, kQuiet), mean_count(*first, kQuiet, kWidth));
}

// Regression: blocks were judged at the end of a batch, which a render that was resumed from 16 samples had not seen.
TEST(L3_Resume, AdaptiveRendersResumeWithTheSameBits) {
  const auto whole = render_film(adaptive_settings(64));
  EXPECT_TRUE(same_samples(*whole, *render_film(adaptive_settings(64), render_film(adaptive_settings(16)))));
}

// Samples of the quiet blocks cost more than others.
std::shared_ptr<const film::Film> render_costly_below(const GradusSettings& settings,
                                                      std::shared_ptr<const film::Film> from) {
  const auto render = start(settings, fake_factory([](FakeIntegrator* fake) {
                              fake->quiet_until = kQuiet;
                              fake->rays_below = 40;
                            }),
                            std::move(from));
  render->wait(-1.0);
  return render->film();
}

// Regression: the cost of blocks, and which of them had stopped, was lost between the two renders.
TEST(L3_Resume, BlocksKeepTheirCostAndTheirStop) {
  GradusSettings settings = adaptive_settings(80, 0.05f);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  const auto part = [&](uint32_t samples, std::shared_ptr<const film::Film> from) {
    settings.samples = samples;
    return render_costly_below(settings, std::move(from));
  };
  const auto whole = part(80, nullptr);
  const std::string path = testing::TempDir() + "/adaptive.exr";
  std::shared_ptr<const film::Film> last;
  for (const uint32_t samples : {16u, 48u, 64u, 80u}) {
    last = part(samples, last);
    film_io::save_film(*last, path);
    last = film_io::load_film(path);
    EXPECT_EQ(last->shared.mean, samples);
  }
  std::remove(path.c_str());
  EXPECT_TRUE(same_samples(*whole, *last));
  EXPECT_EQ(whole->shared.rays, last->shared.rays);
  EXPECT_LT(mean_count(*whole, 0, 16), 80.0) << "stopped";
}

// Regression: the unknown cost of samples that were not taken adaptively counted as 0 after the render was resumed
// twice.
TEST(L3_Resume, SamplesOfUnknownCostStayUnknown) {
  GradusSettings settings = adaptive_settings(16, 0.0f);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  const auto part = [&](uint32_t samples, std::shared_ptr<const film::Film> from) {
    settings.samples = samples;
    return render_costly_below(settings, std::move(from));
  };
  const auto plain = part(16, nullptr);
  settings.noise_threshold = 0.001f;
  const std::string path = testing::TempDir() + "/adaptive_after_plain.exr";
  film_io::save_film(*part(48, plain), path);
  const auto halfway = film_io::load_film(path);
  std::remove(path.c_str());
  EXPECT_EQ(halfway->shared.uncounted, 16u);
  EXPECT_TRUE(same_samples(*part(80, plain), *part(80, halfway)));
}

// A lower threshold resumes blocks that had stopped at a higher one; with the same threshold, their counts must not
// change.
TEST(L3_Resume, ALowerThresholdResumesBlocksThatAHigherOneStopped) {
  const auto settings = [](uint32_t samples, float threshold) {
    GradusSettings s = adaptive_settings(samples, threshold);
    s.integrator = GRADUS_INTEGRATOR_PATH;
    return s;
  };
  const auto coarse = render_film(settings(64, 0.06f));
  ASSERT_EQ(mean_count(*coarse, 0, 16), 16.0);
  ASSERT_GT(mean_count(*coarse, kWidth - 16, kWidth), 60.0);
  EXPECT_GT(mean_count(*render_film(settings(96, 1e-6f), coarse), 0, 16), 16.0);
  EXPECT_THROW(start(settings(96, 0.0f), quiet_at_the_left(), coarse), Error);
}

// Sums and counts suffice: a block with more samples has a larger weight.
TEST(L3_Merge, FilmsOfUnequalCountsAreAddedPixelByPixel) {
  GradusSettings settings = adaptive_settings(32);
  const auto first = render_film(settings);
  film::Film merged = *first;
  settings.first_sample = 16;  // the noisy blocks have taken these already
  const auto overlapping = render_film(settings);
  try {
    render::merge_films(&merged, *overlapping);
    FAIL();
  } catch (const Error& e) {
    const uint32_t end = std::max(first->samples.list().back().end, overlapping->samples.list().back().end);
    EXPECT_EQ(std::string(e.what()),
              "the films share samples: render one of them with first_sample " + std::to_string(end));
  }
  settings.first_sample = 256;
  const auto second = render_film(settings);
  render::merge_films(&merged, *second);
  for (const int x : {3, kWidth - 5}) {
    const size_t i = merged.index(x, 7);
    for (int half = 0; half < film::kHalves; ++half) {
      EXPECT_EQ(merged.count[half][i], first->count[half][i] + second->count[half][i]);
      EXPECT_EQ(merged.components[0].primal[half][i].x,
                first->components[0].primal[half][i].x + second->components[0].primal[half][i].x);
      EXPECT_EQ(merged.pair_count[half][film::kUp][i],
                first->pair_count[half][film::kUp][i] + second->pair_count[half][film::kUp][i]);
    }
  }
  EXPECT_NE(merged.count[0][merged.index(3, 7)], merged.count[0][merged.index(kWidth - 5, 7)]);
  EXPECT_THROW(start(adaptive_settings(1024), quiet_at_the_left(), std::make_shared<const film::Film>(merged)), Error)
      << "it is not resumed";
}

// Samples that finished blocks leave are not distributed beyond what the other blocks take in the batch.
TEST(Adaptive, SamplesThatBlocksLeaveAreSaved) {
  const auto film = render_film(adaptive_settings(256, 0.06f));
  EXPECT_EQ(mean_count(*film, 0, 16), 16.0);
  EXPECT_LT(mean_count(*film, 0, kWidth), 200.0);
}

}  // namespace
}  // namespace gradus::adaptive_test
