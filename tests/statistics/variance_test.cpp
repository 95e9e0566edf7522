// A8: compares the reported variance of the mean with the spread over seeds. A10: seeds and pixels are uncorrelated.
#include <cmath>

#include <gtest/gtest.h>

#include "film/features.h"
#include "film/film.h"
#include "gradient/gradient_integrator.h"
#include "reconstruct/poisson/solver.h"
#include "render/block_noise.h"
#include "render/render.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::variance_test {
namespace {

// Returns the estimated variance of the mean of each pixel and channel.
std::vector<float> read_variance(const film::Film& film) {
  const auto height = film.region.height();
  const size_t row = size_t(film.region.width()) * size_t(film.color_channels);
  std::vector<float> variance(row * size_t(height));
  for (int y = 0; y < height; ++y) film::read_variance_row(film, y, variance.data() + size_t(y) * row);
  return variance;
}

using test::Scenario;

GradusSettings sobol_settings(uint32_t size) {
  GradusSettings settings = test::test_settings(size, size);
  settings.independent_sampler = 0;
  settings.max_bounces = 4;
  return settings;
}

class A8_Variance : public testing::TestWithParam<Scenario> {};

// Returns the sum over a block of 16×16 pixels.
template <class Value>
double block_sum(uint32_t width, uint32_t x0, uint32_t y0, const Value& value) {
  double sum = 0.0;
  for (uint32_t y = y0; y < y0 + 16; ++y) {
    for (uint32_t i = 3 * (y * width + x0); i < 3 * (y * width + x0 + 16); ++i) sum += value(i);
  }
  return sum;
}

// Samples lie at the pixel centres. Otherwise a whole pixel block would share its jitter along the edges of a bright
// light, and a few blocks would dominate. The primal of the gradient integrator has the same bits.
TEST_P(A8_Variance, HalfBuffersAgreeWithTheSpreadOverSeeds) {
  test::PathScene scene;
  test::build(GetParam(), &scene);
  constexpr uint32_t size = 32;  // four blocks
  GradusSettings settings = sobol_settings(size);
  test::sample_at_pixel_centres(&settings);
  integrator::IntegratorContext context = scene.context(settings);
  const int seeds = test::full_run() ? 64 : 32;
  test::Moments images, variances;
  for (int seed = 0; seed < seeds; ++seed) {
    context.settings.seed = static_cast<uint32_t>(seed);
    film::Film film = test::make_test_film(context.settings, false);
    test::sample_film(*integrator::make_path_integrator(context), 0, 16, &film);
    images.add(film::read_images(film, 0).primal);
    variances.add(read_variance(film));
  }
  for (const uint32_t y : {0u, 16u}) {
    for (const uint32_t x : {0u, 16u}) {
      const double estimated = block_sum(size, x, y, [&](uint32_t i) { return variances.mean(i); });
      const double empirical = block_sum(size, x, y, [&](uint32_t i) { return images.variance_of_mean(i) * seeds; });
      std::printf("  %.3f", estimated / empirical);
      EXPECT_GT(estimated / empirical, 0.85) << x << ", " << y;
      EXPECT_LT(estimated / empirical, 1.15) << x << ", " << y;
    }
  }
  std::printf("\n");
}

INSTANTIATE_TEST_SUITE_P(All, A8_Variance,
                         testing::Values(Scenario::DiffuseArea, Scenario::PointAndSun, Scenario::World,
                                         Scenario::RoughMetal, Scenario::Glass, Scenario::LightsSeen),
                         [](const testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); });

// Features get their noise from the lens alone in this scene.
TEST(A8_Features, HalvesAgreeWithTheSpreadOverSeeds) {
  test::PathScene scene;
  test::build(Scenario::Mirror, &scene);
  scene.camera_desc.aperture_radius = 0.15f;
  constexpr uint32_t size = 32;  // four blocks
  integrator::IntegratorContext context = scene.context(sobol_settings(size));
  const int seeds = test::full_run() ? 64 : 32;
  test::Moments images[3], variances[3];
  for (int seed = 0; seed < seeds; ++seed) {
    context.settings.seed = static_cast<uint32_t>(seed);
    film::Film film = test::make_test_film(context.settings, false);
    film::add_pass_channels(schema::feature_passes(), &film);
    test::sample_film(*integrator::make_path_integrator(context), 0, 16, &film);
    const film::Features features = film::read_features(film);
    const film::FeatureImage* all[3] = {&features.normal, &features.albedo, &features.depth};
    for (int k = 0; k < 3; ++k) {
      images[k].add(all[k]->values);
      variances[k].add(all[k]->variance);
    }
  }
  for (int k = 0; k < 3; ++k) {
    double estimated = 0.0, empirical = 0.0;
    for (size_t i = 0; i < images[k].size(); ++i) {
      estimated += variances[k].mean(i);
      empirical += images[k].variance_of_mean(i) * seeds;
    }
    std::printf("  %.3f", estimated / empirical);
    EXPECT_GT(estimated / empirical, 0.85) << k;
    EXPECT_LT(estimated / empirical, 1.15) << k;
  }
  std::printf("\n");
}

// Adaptive samples: the estimate still agrees with the spread, and the mean with that of equal counts. Both could be
// biased, because counts depend on the samples that they weight: a bright outlier causes more samples and then counts
// for less.
TEST(A8_Adaptive, SamplesKeepEstimateAndMean) {
  constexpr uint32_t size = 40, samples = 32;  // 9 pixel blocks; light, shadow and walls differ in noise
  test::PathScene scene;
  test::build(Scenario::DiffuseArea, &scene);
  GradusSettings settings = sobol_settings(size);
  settings.samples = samples;
  settings.threads = 2;
  const std::shared_ptr<const scene::Snapshot> snapshot = scene.context(settings).snapshot;
  const int seeds = test::full_run() ? 64 : 16;
  test::Moments shared, equal;
  double estimated = 0.0;
  uint32_t minimum = UINT32_MAX, maximum = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    settings.seed = uint32_t(seed);
    for (const float threshold : {1e-6f, 0.0f}) {
      settings.noise_threshold = threshold;
      // Both integrators have the same primal.
      settings.integrator = threshold > 0.0f ? GRADUS_INTEGRATOR_GRADIENT : GRADUS_INTEGRATOR_PATH;
      render::Render render(nullptr, snapshot, settings);
      ASSERT_TRUE(render.wait(-1.0));
      const std::shared_ptr<const film::Film> film = render.film();
      (threshold > 0.0f ? shared : equal).add(film::read_images(*film, 0).primal);
      if (!(threshold > 0.0f)) continue;
      for (const float v : read_variance(*film)) estimated += v / seeds;
      for (size_t i = 0; i < film->count[0].size(); ++i) {
        const uint32_t n = film::samples_at(*film, i);
        minimum = std::min(minimum, n);
        maximum = std::max(maximum, n);
      }
    }
  }
  EXPECT_LT(minimum, samples * 3 / 4);
  // The maximum is about twice the minimum, because REGULARIZED removes much of the noise.
  EXPECT_GT(maximum, samples * 5 / 4);
  double empirical = 0.0, difference = 0.0, sum = 0.0;
  for (size_t i = 0; i < shared.size(); ++i) {
    empirical += shared.variance_of_mean(i) * seeds;
    difference += shared.mean(i) - equal.mean(i);
    sum += equal.mean(i);
  }
  std::printf("  counts %u to %u, estimate/spread %.3f, mean %+.3f %%\n", minimum, maximum, estimated / empirical,
              100.0 * difference / sum);
  EXPECT_GT(estimated / empirical, 0.85);
  EXPECT_LT(estimated / empirical, 1.3);  // The ratio is 1.23 over 16 seeds.
  EXPECT_LT(std::fabs(difference), 0.005 * sum);
}

class A8_Delivered : public testing::TestWithParam<Scenario> {};

constexpr uint32_t kReconstructions[] = {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2,
                                         GRADUS_RECONSTRUCTION_L1};

std::vector<float> reconstructed(const film::Film& film, uint32_t reconstruction) {
  reconstruct::SolveReport report;
  return reconstruction == GRADUS_RECONSTRUCTION_NONE
             ? film::read_images(film, 0).primal
             : reconstruct::reconstruct(
                   film, 0, reconstruction, 0.0f, [] { return false; }, &report);
}

// Returns the sum of squared errors over the values of an image, as the estimate that stops pixel blocks gives it.
double estimated_error(const film::Film& film, uint32_t reconstruction, const std::vector<float>& image) {
  const double relative =
      render::estimate_noise(film, {film.region}, reconstruction, 0.0f, [] { return false; }).front().relative_error;
  double signal = 0.0;
  for (size_t i = 0; i < image.size(); i += 3) {
    const double gray = (double(image[i]) + image[i + 1] + image[i + 2]) / 3.0;
    signal += 3.0 * (gray * gray + 1e-3);
  }
  return relative * relative * signal;
}

// Regression: pixel blocks stopped by the error of L2 whatever the delivered reconstruction, so L1 took more samples
// than its threshold required. An estimate with L1's own weights, which follow the noise, would have stopped it much
// too early.
TEST_P(A8_Delivered, ErrorThatStopsBlocksIsThatOfTheDeliveredReconstruction) {
  test::PathScene scene;
  test::build(GetParam(), &scene);
  GradusSettings settings = sobol_settings(48);
  test::sample_at_pixel_centres(&settings);
  integrator::IntegratorContext context = scene.context(settings);
  const int seeds = test::full_run() ? 64 : 16;
  test::Moments images[3];
  double estimated[3] = {};
  for (int seed = 0; seed < seeds; ++seed) {
    context.settings.seed = uint32_t(seed);
    film::Film film = test::make_test_film(context.settings, true);
    film.settings = context.settings;
    test::sample_film(*gradient::make_gradient_integrator(context), 0, 16, &film);
    for (int k = 0; k < 3; ++k) {
      const std::vector<float> image = reconstructed(film, kReconstructions[k]);
      images[k].add(image);
      estimated[k] += estimated_error(film, kReconstructions[k], image) / seeds;
    }
  }
  for (int k = 0; k < 3; ++k) {
    double spread = 0.0;
    for (size_t i = 0; i < images[k].size(); ++i) spread += images[k].variance_of_mean(i) * seeds;
    const std::string name = schema::choice_name(*schema::find_option("reconstruction"), kReconstructions[k]);
    std::printf("  %s %.3f\n", name.c_str(), estimated[k] / spread);
    EXPECT_GT(estimated[k] / spread, 0.6) << name;
    EXPECT_LT(estimated[k] / spread, 1.5) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, A8_Delivered,
                         testing::Values(Scenario::DiffuseArea, Scenario::RoughMetal, Scenario::World),
                         [](const testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); });

// Returns the residuals of images against their mean over seeds. Samples lie at the pixel centres, because the jitter
// that neighbours share would correlate them at edges.
std::vector<std::vector<double>> residuals(uint32_t size, int seeds) {
  test::PathScene scene;
  test::build(Scenario::World, &scene);
  GradusSettings settings = sobol_settings(size);
  test::sample_at_pixel_centres(&settings);
  integrator::IntegratorContext context = scene.context(settings);
  std::vector<std::vector<double>> images;
  std::vector<double> mean(size * size, 0.0);
  for (int seed = 0; seed < seeds; ++seed) {
    context.settings.seed = static_cast<uint32_t>(seed);
    film::Film film = test::make_test_film(context.settings, false);
    test::sample_film(*integrator::make_path_integrator(context), 0, 2, &film);
    const std::vector<float> image = film::read_images(film, 0).primal;
    std::vector<double>& residual = images.emplace_back(mean.size());
    for (size_t i = 0; i < mean.size(); ++i) {
      residual[i] = image[3 * i + 1];
      mean[i] += residual[i] / seeds;
    }
  }
  for (auto& image : images) {
    for (size_t i = 0; i < mean.size(); ++i) image[i] -= mean[i];
  }
  return images;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b, size_t shift) {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (size_t i = 0; i + shift < a.size(); ++i) {
    ab += a[i] * b[i + shift];
    aa += a[i] * a[i];
    bb += b[i + shift] * b[i + shift];
  }
  return ab / std::sqrt(aa * bb);
}

TEST(A10_Seeds, ResidualsAreUncorrelated) {
  constexpr uint32_t size = 96;
  const auto images = residuals(size, 24);
  // Subtracting the mean of n seeds causes a correlation of −1/(n − 1) between two of them.
  EXPECT_NEAR(correlation(images[0], images[1], 0), -1.0 / 23.0, 0.05);
  EXPECT_NEAR(correlation(images[0], images[0], 1), 0.0, 0.05);
  EXPECT_NEAR(correlation(images[0], images[0], size), 0.0, 0.05);
}

}  // namespace
}  // namespace gradus::variance_test
