// Compares the integrators with a second, independent path tracer: A5 (z-tests of pixels), A6 (global bias) and A7 (the
// error falls with samples).
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <glm/gtc/matrix_transform.hpp>

#include "film/pixel_blocks.h"
#include "gradient/gradient_integrator.h"
#include "integrator/guide_training.h"
#include "shading/program_builder.h"
#include "support/bsdf_only.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::truth_test {
namespace {

using test::PathScene;

// There are at least 1,400 blocks of 5×5 pixels. With fewer the sign ratio of noise alone, 1.25/√blocks, comes too near
// its bound. The full run takes 2e6 samples.
constexpr uint32_t kWidth = 224, kHeight = 160;
constexpr int kPixels = int(kWidth * kHeight);
int samples() { return test::full_run() ? 56 : 6; }
int reference_samples() { return test::full_run() ? 280 : 28; }
// The z-test assumes that the mean of a few dozen samples is normally distributed. So it compares single pixels in the
// full run and squares of 4×4 pixels otherwise.
uint32_t block_side() { return test::full_run() ? 1 : 4; }

// The lights are large, so that BSDF sampling alone finds them.
enum class Truth { Box, GlassBalls, RoughMetal, Textures, Environment, Sky, ManyLights, Motion, Gap, Count };
const char* const kNames[] = {"Box", "GlassBalls", "RoughMetal", "Textures", "Environment",
                              "Sky", "ManyLights", "Motion",     "Gap"};

uint64_t checker(PathScene* scene, uint32_t closure, const Vec3& a, const Vec3& b, float scale) {
  test::ProgramBuilder p;
  const int where = p.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
  const int color = p.add(GRADUS_OP_CHECKER, {test::In::from(where), a, b, scale});
  std::vector<test::In> inputs{test::In::from(color)};
  if (closure == GRADUS_OP_EMISSION) inputs.push_back(1.0f);
  return scene->material(p.desc(p.add(closure, inputs)));
}

// Returns a sky whose sun is 70° wide and illuminates the box from the side of the camera.
uint64_t sky(PathScene* scene) {
  test::ProgramBuilder p;
  const int where = p.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
  const int color =
      p.add(GRADUS_OP_SKY, {test::In::from(where)}, GRADUS_SKY_SINGLE_SCATTERING, {0.9f, 0.5f, 1.2f, 0.1f, 0, 1, 1, 1});
  return scene->material(p.desc(p.add(GRADUS_OP_EMISSION, {test::In::from(color), 0.3f})));
}

void add_many_lights(PathScene* scene) {
  for (int i = 0; i < 36; ++i) {
    test::Surface light;
    light.emission = Rgb(0.5f + 0.1f * float(i % 7), 1.0f, 2.0f - 0.05f * float(i));
    const Vec3 corner(-0.9f + 0.3f * float(i % 6), 0.95f, -0.9f + 0.3f * float(i / 6));
    scene->quad(corner, Vec3(0.2f, 0, 0), Vec3(0, 0, 0.2f), scene->material(light));
  }
  GradusLight ball = test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(-0.3f, -0.3f, 0.2f)), Rgb(1.0f));
  ball.radius = 0.25f;
  scene->light(ball);
}

// Adds a large light that swings, a ball that swells while it moves, and a camera that moves sideways.
void add_motion(PathScene* scene) {
  scene->scene.shutter_poses = {test::translation(Vec3(-0.2f, 0, 0)),
                                test::translation(Vec3(0.3f, -0.4f, 0)) * glm::rotate(Mat4(1.0f), 0.5f, Vec3(0, 0, 1))};
  test::add_ceiling_light(scene, 1.5f, 1.4f);
  scene->scene.shutter_poses = {Mat4(1.0f), test::translation(Vec3(-0.3f, 0.3f, 0))};
  scene->swelling = 1.5f;
  scene->ball(Vec3(0.3f, -0.6f, 0.1f), 0.3f, scene->material(test::matte(Rgb(0.5f))), 6, true);
  scene->open_shutter({1.0f, 0.2f, 1.0f}, {Mat4(1.0f), test::translation(Vec3(0.1f, 0, 0))});
}

// Adds a light behind a wall, around which light comes over a gap: most paths are guided there.
void add_gap(PathScene* scene) {
  const uint64_t white = scene->material(test::matte(Rgb(0.7f)));
  test::Surface light;
  light.emission = Rgb(8.0f);
  scene->quad(Vec3(0.3f, -1, -1), Vec3(0, 0, 2), Vec3(0, 1.4f, 0), white);
  scene->quad(Vec3(0.3f, -1, 1), Vec3(0.7f, 0, 0), Vec3(0, 2, 0), white);
  scene->quad(Vec3(0.35f, -0.9f, -0.9f), Vec3(0, 0, 1.8f), Vec3(0.6f, 0, 0), scene->material(light));
}

void build(Truth truth, PathScene* scene) {
  test::Surface floor = test::matte(Rgb(0.6f));
  if (truth == Truth::RoughMetal) {
    floor.glossy = Rgb(0.3f);
    floor.glossy_roughness = 0.25f;
  }
  test::add_box(scene, floor);
  if (truth == Truth::Environment) {
    scene->world(checker(scene, GRADUS_OP_EMISSION, Vec3(2.0f, 1.5f, 1.0f), Vec3(0.1f, 0.2f, 0.4f), 3.0f), 64);
    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 1.4f);  // The camera sees the world beyond the box.
  } else if (truth == Truth::Sky) {
    scene->world(sky(scene), 64);
    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 1.4f);
  } else if (truth == Truth::Textures) {
    const uint64_t light = checker(scene, GRADUS_OP_EMISSION, Vec3(2.0f), Vec3(0.2f, 0.3f, 0.8f), 5.0f);
    scene->quad(Vec3(-0.8f, 0.98f, -0.8f), Vec3(1.6f, 0, 0), Vec3(0, 0, 1.6f), light);
    const uint64_t wall = checker(scene, GRADUS_OP_DIFFUSE, Vec3(0.8f), Vec3(0.1f, 0.3f, 0.5f), 7.0f);
    scene->quad(Vec3(-0.8f, -0.9f, -0.8f), Vec3(1.2f, 0, 0.3f), Vec3(0, 1.3f, 0), wall);
  } else if (truth == Truth::ManyLights) {
    add_many_lights(scene);
  } else if (truth == Truth::Motion) {
    add_motion(scene);
  } else if (truth == Truth::Gap) {
    add_gap(scene);
  } else {
    test::add_ceiling_light(scene, 1.5f, 1.6f);
  }
  if (truth == Truth::GlassBalls) {
    scene->ball(Vec3(-0.4f, -0.5f, 0.1f), 0.45f, scene->material(test::glass(0.0f)), 10, true);
    scene->ball(Vec3(0.45f, -0.5f, 0.2f), 0.45f, scene->material(test::glass(0.3f)), 10, true);
  } else if (truth == Truth::RoughMetal) {
    scene->ball(Vec3(0.0f, -0.3f, 0.0f), 0.6f, scene->material(test::glossy(0.5f)), 10, true);
  } else if (truth != Truth::Textures && truth != Truth::Motion) {
    scene->ball(Vec3(0.3f, -0.6f, 0.1f), 0.4f, scene->material(test::matte(Rgb(0.5f))), 6);
  }
}

enum class Estimator { Path, Gradient, BsdfOnly, GuidedPath, GuidedGradient };

// Returns the means over runs of `side` pixels of a row.
std::vector<float> run_means(const std::vector<float>& image, uint32_t side) {
  std::vector<float> means(image.size() / side, 0.0f);
  for (size_t i = 0; i < image.size(); ++i) means[i / 3 / side * 3 + i % 3] += image[i] / float(side);
  return means;
}

// Moments over samples. Neighbours in a row of a pixel block share their sub-pixel jitter, so variances of sums come
// from whole runs. Rows are independent, because they use different sample numbers.
struct Statistics {
  test::Moments pixels, block_runs, jitter_block_runs;
};

// Computes the moments of `count` images with one sample per pixel, with rows in parallel.
template <class SampleRow>
Statistics sample_images(int count, const SampleRow& sample_row) {
  Statistics moments;
  std::vector<float> image(size_t(kPixels) * 3);
  for (int i = 0; i < count; ++i) {
    tbb::parallel_for(0, int(kHeight), [&](int y) { sample_row(i, y, image.data() + size_t(y) * kWidth * 3); });
    moments.pixels.add(image);
    moments.block_runs.add(run_means(image, block_side()));
    moments.jitter_block_runs.add(run_means(image, film::kPixelBlockSide));
  }
  return moments;
}

Statistics estimate(const integrator::IntegratorContext& context, Estimator estimator) {
  if (estimator == Estimator::BsdfOnly) {
    return sample_images(reference_samples(), [&](int i, int y, float* row) {
      test::Random random(uint64_t(i) * kHeight + uint64_t(y) + 1);
      for (int x = 0; x < int(kWidth); ++x) {
        const Rgb value = test::bsdf_only_sample(context, x, y, &random);
        for (int c = 0; c < 3; ++c) row[3 * x + c] = value[c];
      }
    });
  }
  const bool gradients = estimator == Estimator::Gradient || estimator == Estimator::GuidedGradient;
  const auto integrator =
      gradients ? gradient::make_gradient_integrator(context) : integrator::make_path_integrator(context);
  return sample_images(samples(), [&](int i, int y, float* row) {
    // The film includes the rows above and below, so that all pairs of pixels are present.
    film::Film film(kWidth, kHeight, Region{0, y - 1, int32_t(kWidth), y + 2}, 3, 1, gradients);
    integrator::WorkUnit unit{Region{0, y, int32_t(kWidth), y + 1},
                              uint32_t(2 * (i * film::kPixelBlockSide + y % film::kPixelBlockSide)), 1, nullptr};
    integrator->sample(unit, &film, &film.counters, std::atomic<bool>{false});
    for (int x = 0; x < int(kWidth); ++x) {
      for (int c = 0; c < 3; ++c) row[3 * x + c] = film.components[0].primal[0][film.index(x, y)][c];
    }
  });
}

// Returns the context with guided paths. The guide pays for a part of the surfaces.
integrator::IntegratorContext guided(integrator::IntegratorContext context) {
  std::atomic<uint64_t> cpu{0};
  const integrator::GuideTraining training = integrator::train_guide(context, 40000, std::atomic<bool>{false}, &cpu);
  EXPECT_NE(training.field, nullptr);
  context.snapshot = integrator::guided_snapshot(*context.snapshot, training.field);
  return context;
}

// Returns the moments, which are computed once for all tests.
const Statistics& moments(Truth truth, Estimator estimator) {
  static std::map<std::pair<Truth, Estimator>, Statistics> made;
  const auto key = std::make_pair(truth, estimator);
  if (const auto found = made.find(key); found != made.end()) return found->second;
  PathScene scene;
  build(truth, &scene);
  GradusSettings settings = test::test_settings(kWidth, kHeight);
  settings.max_bounces = 4;
  settings.seed = 1 + uint32_t(estimator);
  integrator::IntegratorContext context = scene.context(settings);
  if (estimator >= Estimator::GuidedPath) context = guided(context);
  return made.emplace(key, estimate(context, estimator)).first->second;
}

using Case = std::tuple<Truth, Estimator>;
class Truths : public ::testing::TestWithParam<Case> {};

struct BlockTest {
  size_t tests = 0, failed = 0;
};

// Runs a z-test for each block and channel, with the pooled variances of its runs.
BlockTest test_blocks(const Statistics& image, const Statistics& truth, double factor) {
  const test::Moments &runs = image.block_runs, &true_runs = truth.block_runs;
  const uint32_t side = block_side();
  const size_t tests = size_t(kWidth / side) * (kHeight / side) * 3;
  const double level = test::sidak(tests * 2 * size_t(Truth::Count));
  BlockTest result;
  for (uint32_t block = 0; block < tests; ++block) {
    const uint32_t channel = block % 3, column = block / 3 % (kWidth / side), row = block / 3 / (kWidth / side);
    double difference = 0.0, variance = 0.0;
    for (uint32_t y = row * side; y < (row + 1) * side; ++y) {
      const size_t i = 3 * (size_t(y) * (kWidth / side) + column) + channel;
      difference += factor * runs.mean(i) - true_runs.mean(i);
      variance += std::max(runs.variance_of_mean(i), 1e-4 / side / runs.count()) + true_runs.variance_of_mean(i);
    }
    ++result.tests;
    result.failed += test::normal_p(difference / std::sqrt(variance)) < level ? 1 : 0;
  }
  return result;
}

struct Bias {
  // Means of the image and of the truth, and the standard deviation of their difference.
  double mean = 0.0, truth = 0.0, deviation = 0.0;
  double sign_ratio = 0.0;
  bool passes() const { return std::fabs(mean - truth) <= 4.0 * deviation && sign_ratio <= 0.1; }
};

Bias measure_bias(const Statistics& all, const Statistics& all_true, double factor) {
  const test::Moments &image = all.pixels, &truth = all_true.pixels;
  Bias bias;
  double variance = 0.0;
  std::vector<double> difference(kPixels);
  for (size_t i = 0; i < image.size(); ++i) {
    bias.mean += factor * image.mean(i) / double(image.size());
    bias.truth += truth.mean(i) / double(image.size());
    difference[i / 3] += factor * image.mean(i) - truth.mean(i);
  }
  for (size_t i = 0; i < all.jitter_block_runs.size(); ++i) {
    variance +=
        factor * factor * all.jitter_block_runs.variance_of_mean(i) + all_true.jitter_block_runs.variance_of_mean(i);
  }
  // Channels of a pixel come from the same paths, so they are treated as fully correlated.
  bias.deviation = std::sqrt(3.0 * variance) / double(all.jitter_block_runs.size());
  test::SignRatio ratio;
  ratio.add(difference, int(kWidth), int(kHeight));
  bias.sign_ratio = ratio.value();
  EXPECT_GE(ratio.blocks, 1400u);
  return bias;
}

TEST_P(Truths, A5_PixelsAgree) {
  const auto [truth, estimator] = GetParam();
  const BlockTest result = test_blocks(moments(truth, estimator), moments(truth, Estimator::BsdfOnly), 1.0);
  EXPECT_LE(double(result.failed), 0.0025 * double(result.tests)) << result.failed << " of " << result.tests;
}

TEST_P(Truths, A6_NoGlobalBias) {
  const auto [truth, estimator] = GetParam();
  const Bias bias = measure_bias(moments(truth, estimator), moments(truth, Estimator::BsdfOnly), 1.0);
  EXPECT_NEAR(bias.mean, bias.truth, 4.0 * bias.deviation);
  EXPECT_LE(bias.sign_ratio, 0.1);
  std::printf("  mean %.5f, truth %.5f, 1 sigma %.2f %%, sign ratio %.3f\n", bias.mean, bias.truth,
              100.0 * bias.deviation / bias.truth, bias.sign_ratio);
}

std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  static const char* const estimators[] = {"Path", "Gradient", "BsdfOnly", "GuidedPath", "GuidedGradient"};
  return std::string(kNames[int(std::get<0>(info.param))]) + estimators[int(std::get<1>(info.param))];
}

INSTANTIATE_TEST_SUITE_P(All, Truths,
                         ::testing::Combine(::testing::Values(Truth::Box, Truth::GlassBalls, Truth::RoughMetal,
                                                              Truth::Textures, Truth::Environment, Truth::Sky,
                                                              Truth::ManyLights, Truth::Motion),
                                            ::testing::Values(Estimator::Path, Estimator::Gradient)),
                         name_of);

INSTANTIATE_TEST_SUITE_P(Guided, Truths,
                         ::testing::Combine(::testing::Values(Truth::RoughMetal, Truth::Environment, Truth::Motion,
                                                              Truth::Gap),
                                            ::testing::Values(Estimator::GuidedPath, Estimator::GuidedGradient)),
                         name_of);

// Scenes of the pooled test. The last is too noisy for it.
constexpr int kPooled = int(Truth::Gap);

// Returns the mean of these scenes' relative differences divided by its standard deviation. `factor` scales the images.
double pooled_z(Estimator estimator, double factor) {
  double sum = 0.0, variance = 0.0;
  for (int i = 0; i < kPooled; ++i) {
    const Bias bias = measure_bias(moments(Truth(i), estimator), moments(Truth(i), Estimator::BsdfOnly), factor);
    sum += bias.mean / bias.truth - 1.0;
    variance += std::pow(bias.deviation / bias.truth, 2);
  }
  return sum / std::sqrt(variance);
}

// Shows that the tests detect a darkening of one percent despite the noise. With few samples all scenes together show
// it; in the full run each scene does.
TEST(A6_Bias, OnePercentOfDarkeningIsCaught) {
  for (const Estimator estimator : {Estimator::Path, Estimator::Gradient}) {
    EXPECT_LT(std::fabs(pooled_z(estimator, 1.0)), 4.0);
    EXPECT_LT(pooled_z(estimator, 0.99), -4.0);
    for (int i = 0; i < kPooled && test::full_run(); ++i) {
      EXPECT_FALSE(measure_bias(moments(Truth(i), estimator), moments(Truth(i), Estimator::BsdfOnly), 0.99).passes())
          << kNames[i];
    }
  }
}

// Returns the mean squared error of images with n samples against a reference with many more.
double mean_squared_error(const integrator::IntegratorContext& base, int n, int images,
                          const std::vector<double>& reference) {
  double error = 0.0;
  for (int k = 0; k < images; ++k) {
    integrator::IntegratorContext context = base;
    context.settings.seed = uint32_t(1000 * n + k);
    film::Film film = test::make_test_film(context.settings, false);
    test::sample_film(*integrator::make_path_integrator(context), 0, uint32_t(n), &film);
    const std::vector<float> image = film::read_images(film, 0).primal;
    for (size_t pixel = 0; pixel < image.size() / 3; ++pixel) {
      const double gray = (reference[3 * pixel] + reference[3 * pixel + 1] + reference[3 * pixel + 2]) / 3.0;
      for (size_t c = 0; c < 3; ++c)
        error += std::pow(image[3 * pixel + c] - reference[3 * pixel + c], 2) / (1e-3 + gray * gray);
    }
  }
  return error / images;
}

// A ratio above the bounds means bias; one below them means a wrong reference.
TEST(A7_Convergence, FourTimesTheSamplesQuarterTheError) {
  for (const Truth truth : {Truth::Box, Truth::Environment, Truth::ManyLights}) {
    PathScene scene;
    build(truth, &scene);
    GradusSettings settings = test::test_settings(24, 16);
    settings.max_bounces = 4;
    const integrator::IntegratorContext context = scene.context(settings);
    film::Film film = test::make_test_film(settings, false);
    test::sample_film(*integrator::make_path_integrator(context), 0, 2048, &film);
    const std::vector<float> image = film::read_images(film, 0).primal;
    const std::vector<double> reference(image.begin(), image.end());
    const int images = test::full_run() ? 16 : 4;
    const double ratio =
        mean_squared_error(context, 64, images, reference) / mean_squared_error(context, 16, 4 * images, reference);
    EXPECT_GT(ratio, 0.20) << kNames[int(truth)];
    EXPECT_LT(ratio, 0.32) << kNames[int(truth)];
  }
}

}  // namespace
}  // namespace gradus::truth_test
