// B3: compares reconstructed images with plain path tracing.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "film/film.h"
#include "gradient/gradient_integrator.h"
#include "reconstruct/reconstruct_film.h"
#include "schema/pass_table.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::reconstruction_test {
namespace {

using test::Moments;
using test::PathScene;
using test::Scenario;

std::vector<Scenario> all_scenarios() {
  std::vector<Scenario> all;
  for (int i = 0; i < int(Scenario::Count); ++i) all.push_back(Scenario(i));
  return all;
}

film::Film render(integrator::IntegratorContext context, bool gradient, uint32_t seed, int samples) {
  context.settings.seed = seed;
  film::Film film = test::make_test_film(context.settings, gradient);
  film::add_pass_channels(schema::feature_passes(), &film);
  test::sample_film(
      gradient ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context), 0,
      uint32_t(samples), &film);
  return film;
}

std::vector<float> reconstructed(const film::Film& film, GradusReconstruction reconstruction) {
  reconstruct::SolveReport report;
  return reconstruct::reconstruct_film(
             film, reconstruction, 0.0f, {}, [] { return false; }, &report)
      .image;
}

// Returns the mean of the channels of each pixel.
std::vector<float> gray(const std::vector<float>& rgb) {
  std::vector<float> result(rgb.size() / 3);
  for (size_t i = 0; i < rgb.size(); ++i) result[i / 3] += rgb[i] / 3.0f;
  return result;
}

// Returns the means over blocks of side×side pixels, row by row.
std::vector<float> block_means(const std::vector<float>& image, int width, int height, int side) {
  std::vector<float> result;
  for (int y = 0; y + side <= height; y += side) {
    for (int x = 0; x + side <= width; x += side) {
      double sum = 0.0;
      for (int i = 0; i < side * side; ++i) sum += image[size_t(y + i / side) * size_t(width) + size_t(x + i % side)];
      result.push_back(float(sum / (side * side)));
    }
  }
  return result;
}

// --- L2

// Blocks of 8×8 pixels start 32 pixels apart, so that 24 pixels separate them. There are 12 in each scene.
constexpr int kWidth = 104, kHeight = 72, kBlock = 8, kApart = 4;

struct Comparison {
  Moments path_blocks, l2_blocks, path_pixels, l2_pixels, path_mean, l2_mean;
};

Comparison compare(Scenario scenario) {
  PathScene scene;
  test::build(scenario, &scene);
  GradusSettings settings = test::test_settings(kWidth, kHeight);
  settings.max_bounces = 4;
  test::sample_at_pixel_centres(&settings);
  const integrator::IntegratorContext context = scene.context(settings);
  const int seeds = 64, samples = test::full_run() ? 5 : 1;
  std::vector<std::vector<float>> path(static_cast<size_t>(seeds)), l2(path.size());
  tbb::parallel_for(0, seeds, [&](int k) {
    path[k] = gray(film::read_images(render(context, false, uint32_t(k), samples), 0).primal);
    l2[k] = gray(reconstructed(render(context, true, uint32_t(1000 + k), samples), GRADUS_RECONSTRUCTION_L2));
  });
  Comparison result;
  for (size_t k = 0; k < path.size(); ++k) {
    result.path_pixels.add(path[k]);
    result.l2_pixels.add(l2[k]);
    result.path_blocks.add(block_means(path[k], kWidth, kHeight, kBlock));
    result.l2_blocks.add(block_means(l2[k], kWidth, kHeight, kBlock));
    const auto mean = [](const std::vector<float>& image) {
      double sum = 0.0;
      for (const float v : image) sum += v;
      return std::vector<float>{float(sum / double(image.size()))};
    };
    result.path_mean.add(mean(path[k]));
    result.l2_mean.add(mean(l2[k]));
  }
  return result;
}

const std::vector<Comparison>& comparisons() {
  static const std::vector<Comparison> all = [] {
    std::vector<Comparison> made;
    for (const Scenario scenario : all_scenarios()) made.push_back(compare(scenario));
    return made;
  }();
  return all;
}

TEST(B3_L2, WelchTestsOfBlocksAreUniform) {
  std::vector<double> p_values;
  constexpr int columns = kWidth / kBlock, rows = kHeight / kBlock;
  for (const Comparison& c : comparisons()) {
    for (int row = 0; row < rows; row += kApart) {
      for (int column = 0; column < columns; column += kApart) {
        p_values.push_back(test::welch_p(c.path_blocks, c.l2_blocks, size_t(row * columns + column)));
      }
    }
  }
  ASSERT_GE(p_values.size(), 100u);
  EXPECT_GT(test::uniformity_p(p_values), 0.01);
  std::printf("  %zu blocks, uniform with p = %.3f\n", p_values.size(), test::uniformity_p(p_values));
}

TEST(B3_L2, NoBlockDiffers) {
  for (size_t s = 0; s < comparisons().size(); ++s) {
    const Comparison& c = comparisons()[s];
    const double level = test::sidak(c.path_blocks.size() * comparisons().size());
    for (size_t i = 0; i < c.path_blocks.size(); ++i) {
      EXPECT_GT(test::welch_p(c.path_blocks, c.l2_blocks, i), level) << test::name_of(Scenario(s)) << ", block " << i;
    }
  }
}

// Returns the mean of all scenes' relative differences divided by its standard deviation. `factor` scales the L2
// images.
double pooled_z(double factor) {
  double sum = 0.0, variance = 0.0;
  for (const Comparison& c : comparisons()) {
    const double truth = c.path_mean.mean(0);
    sum += factor * c.l2_mean.mean(0) / truth - 1.0;
    variance += (factor * factor * c.l2_mean.variance_of_mean(0) + c.path_mean.variance_of_mean(0)) / (truth * truth);
  }
  return sum / std::sqrt(variance);
}

TEST(B3_L2, MeansAgreeAndOnePercentOfDarkeningIsCaught) {
  for (size_t s = 0; s < comparisons().size(); ++s) {
    EXPECT_GT(test::welch_p(comparisons()[s].path_mean, comparisons()[s].l2_mean, 0), 6e-5)
        << test::name_of(Scenario(s));
  }
  EXPECT_LT(std::fabs(pooled_z(1.0)), 4.0);
  EXPECT_LT(pooled_z(0.99), -4.0);
}

TEST(B3_L2, DifferencesHaveNoSign) {
  test::SignRatio ratio;
  for (const Comparison& c : comparisons()) {
    std::vector<double> difference(c.path_pixels.size());
    for (size_t i = 0; i < difference.size(); ++i)
      difference[i] = (c.l2_pixels.mean(i) - c.path_pixels.mean(i)) / c.path_mean.mean(0);
    ratio.add(difference, kWidth, kHeight);
  }
  EXPECT_GE(ratio.blocks, 1400u);
  EXPECT_LE(ratio.value(), 0.1);
}

// --- L1 and REGULARIZED are biased. The bias stays within these bounds (docs/method.md).

struct Biased {
  GradusReconstruction reconstruction;
  const char* name;
  double max_mean = 0.005, max_block = 0.03;
};

// REGULARIZED is too dark where rare samples carry the light, because its windows treat them as outliers.
constexpr Biased kBiased[] = {{GRADUS_RECONSTRUCTION_L1, "L1"},
                              {GRADUS_RECONSTRUCTION_REGULARIZED, "REGULARIZED", 0.04, 0.1}};

// Block means of the primal, which is unbiased, and how much the reconstructions of the same renders differ from it.
// They share most of the noise.
struct Differences {
  std::vector<float> truth, from_truth[std::size(kBiased)];
};

void check_bias(const Moments& truth, const Moments& differences, const Biased& biased) {
  const auto& [reconstruction, name, max_mean, max_block] = biased;
  double sum = 0.0, sum_of_differences = 0.0, worst = 0.0;
  for (size_t i = 0; i < truth.size(); ++i) {
    sum += truth.mean(i);
    sum_of_differences += differences.mean(i);
    const double noise = std::sqrt(differences.variance_of_mean(i));
    EXPECT_LE(std::fabs(differences.mean(i)), max_block * truth.mean(i) + 4.0 * noise) << name << ", block " << i;
    worst = std::max(worst, std::fabs(differences.mean(i)) / truth.mean(i));
  }
  EXPECT_LE(std::fabs(sum_of_differences), max_mean * sum) << name;
  std::printf("  %s: mean %+.3f %%, worst block %.2f %%\n", name, 100.0 * sum_of_differences / sum, 100.0 * worst);
}

class B3_Consistent : public testing::TestWithParam<Scenario> {};

TEST_P(B3_Consistent, BiasStaysWithinItsBound) {
  constexpr int width = 64, height = 48, side = 16, samples = 16;
  PathScene scene;
  test::build(GetParam(), &scene);
  GradusSettings settings = test::test_settings(width, height);
  settings.max_bounces = 4;
  const integrator::IntegratorContext context = scene.context(settings);
  std::vector<Differences> all(test::full_run() ? 64 : 8);
  tbb::parallel_for(size_t(0), all.size(), [&](size_t k) {
    const film::Film film = render(context, true, uint32_t(k), samples);
    all[k].truth = block_means(gray(film::read_images(film, 0).primal), width, height, side);
    for (size_t r = 0; r < std::size(kBiased); ++r) {
      std::vector<float>& difference = all[k].from_truth[r];
      difference = block_means(gray(reconstructed(film, kBiased[r].reconstruction)), width, height, side);
      for (size_t i = 0; i < difference.size(); ++i) difference[i] -= all[k].truth[i];
    }
  });
  Moments truth, differences[std::size(kBiased)];
  for (const Differences& d : all) {
    truth.add(d.truth);
    for (size_t r = 0; r < std::size(kBiased); ++r) differences[r].add(d.from_truth[r]);
  }
  for (size_t r = 0; r < std::size(kBiased); ++r) check_bias(truth, differences[r], kBiased[r]);
}

// Returns the relative bias of REGULARIZED: its total light divided by that of the primal, minus 1.
double bias_of_regularized(const integrator::IntegratorContext& context, int samples, size_t seeds) {
  std::vector<double> sampled(seeds), solved(seeds);
  tbb::parallel_for(size_t(0), seeds, [&](size_t k) {
    const film::Film film = render(context, false, uint32_t(k), samples);
    const std::vector<float> before = gray(film::read_images(film, 0).primal),
                             after = gray(reconstructed(film, GRADUS_RECONSTRUCTION_REGULARIZED));
    sampled[k] = std::accumulate(before.begin(), before.end(), 0.0);
    solved[k] = std::accumulate(after.begin(), after.end(), 0.0);
  });
  return std::accumulate(solved.begin(), solved.end(), 0.0) / std::accumulate(sampled.begin(), sampled.end(), 0.0) -
         1.0;
}

TEST(B3_Regularized, BiasFallsWithSamples) {
  for (const Scenario scenario : {Scenario::DiffuseArea, Scenario::Mirror, Scenario::LightsUnseen}) {
    PathScene scene;
    test::build(scenario, &scene);
    GradusSettings settings = test::test_settings(64, 48);
    settings.max_bounces = 4;
    const integrator::IntegratorContext context = scene.context(settings);
    const double few = bias_of_regularized(context, 16, 8), many = bias_of_regularized(context, 256, 2);
    std::printf("  %s: %+.3f %% of the light, with 16 times the samples %+.3f %%\n", test::name_of(scenario),
                100.0 * few, 100.0 * many);
    EXPECT_LE(std::fabs(many), 0.65 * std::fabs(few)) << test::name_of(scenario);
  }
}

INSTANTIATE_TEST_SUITE_P(All, B3_Consistent, testing::ValuesIn(all_scenarios()),
                         [](const testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); });

}  // namespace
}  // namespace gradus::reconstruction_test
