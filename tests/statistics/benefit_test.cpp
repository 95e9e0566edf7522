// B5: compares the error of gradient-domain and plain path tracing after equal time.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "gradient/gradient_integrator.h"
#include "render/render.h"
#include "schema/options.h"
#include "support/developed.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::benefit_test {
namespace {

using test::Scenario;

constexpr uint32_t kWidth = 48, kHeight = 36;
int seeds() { return test::full_run() ? 32 : 8; }
uint32_t samples() { return test::full_run() ? 16 : 8; }

struct Measured {
  // Relative squared error of one image, from the spread over seeds, because both estimators are unbiased.
  double error = 0.0;
  double seconds = 0.0;
};

Measured measure(const integrator::IntegratorContext& base, bool gradient, uint32_t count) {
  Measured result;
  test::Moments moments;
  for (int seed = 0; seed < seeds(); ++seed) {
    integrator::IntegratorContext context = base;
    context.settings.seed = uint32_t(seed);
    const auto film = std::make_shared<film::Film>(test::make_test_film(context.settings, gradient));
    film->settings = context.settings;
    const uint64_t began = thread_cpu_nanoseconds();
    test::sample_film(
        gradient ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context), 0, count,
        film.get());
    result.seconds += 1e-9 * double(thread_cpu_nanoseconds() - began);
    moments.add(
        test::reconstructed(film, gradient ? GRADUS_RECONSTRUCTION_L2 : GRADUS_RECONSTRUCTION_NONE, film->region));
  }
  for (size_t i = 0; i < moments.size(); i += 4) {
    const double gray = (moments.mean(i) + moments.mean(i + 1) + moments.mean(i + 2)) / 3.0;
    for (size_t c = 0; c < 3; ++c) result.error += moments.variance_of_mean(i + c) * seeds() / (1e-3 + gray * gray);
  }
  return result;
}

constexpr Scenario kScenarios[] = {Scenario::DiffuseArea, Scenario::PointAndSun, Scenario::World,
                                   Scenario::RoughMetal,  Scenario::Glass,       Scenario::Transparent};

// Path tracing has an error that falls as 1/n. So its error after the time of the gradient integrator follows from its
// own samples and time.
TEST(B5_Benefit, MostScenesAreBetterInTheSameTimeAndNoneIsMuchWorse) {
  int better = 0;
  for (const Scenario scenario : kScenarios) {
    test::PathScene scene;
    test::build(scenario, &scene);
    // The light is outside the picture. At its edge, where it is 160 times as bright as the wall behind it, L2 spreads
    // the noise of pixel coverage.
    scene.camera(Vec3(0.0f, -0.3f, 3.2f), Vec3(0.0f, -0.4f, 0.0f), 0.6f);
    GradusSettings settings = test::test_settings(kWidth, kHeight);
    settings.independent_sampler = 0;
    settings.max_bounces = 6;
    const integrator::IntegratorContext context = scene.context(settings);
    const Measured path = measure(context, false, samples()), gradient = measure(context, true, samples());
    const double ratio = gradient.error / path.error * gradient.seconds / path.seconds;
    std::printf("  %-12s relMSE %.2f of path tracing at the same samples, %.2f of its time: %.2f at the same time\n",
                test::name_of(scenario), gradient.error / path.error, gradient.seconds / path.seconds, ratio);
    better += ratio < 1.0 ? 1 : 0;
    EXPECT_LT(ratio, 1.5) << test::name_of(scenario);
  }
  EXPECT_GE(better, 4);
}

// --- The same comparison for whole renders with default options, including pilot and reconstruction.

// Returns the weight of the squared error of value i in an RGBA image, 0 for alpha.
double weight(const test::Moments& truth, size_t i) {
  const size_t pixel = i / 4 * 4;
  const double gray = (truth.mean(pixel) + truth.mean(pixel + 1) + truth.mean(pixel + 2)) / 3.0;
  return i % 4 == 3 ? 0.0 : 1.0 / (1e-3 + gray * gray);
}

struct Rendered {
  std::vector<std::vector<float>> images;  // one for each seed
  test::Moments moments;
  double seconds = 0.0;
  std::string integrator;
};

Rendered render(test::PathScene* scene, uint32_t integrator, uint32_t first_seed) {
  GradusSettings settings = schema::default_settings();
  settings.width = kWidth;
  settings.height = kHeight;
  settings.samples = samples();
  settings.noise_threshold = 0.0f;
  settings.denoiser = GRADUS_DENOISER_NONE;
  settings.max_bounces = 6;
  settings.threads = 1;
  settings.integrator = integrator;
  const auto snapshot = scene->context(settings).snapshot;
  Rendered result;
  for (int k = 0; k < seeds(); ++k) {
    settings.seed = first_seed + uint32_t(k);
    const uint64_t began = process_cpu_nanoseconds();
    render::Render render(nullptr, snapshot, settings);
    EXPECT_TRUE(render.wait(-1.0));
    result.seconds += 1e-9 * double(process_cpu_nanoseconds() - began);
    std::vector<float>& image = result.images.emplace_back(size_t(kWidth) * kHeight * 4);
    render.read_pass(GRADUS_PASS_COMBINED, image.data(), image.size());
    result.moments.add(image);
    result.integrator = nlohmann::json::parse(render.stats_json())["integrator"];
  }
  return result;
}

// Returns the error of one path-traced image from the spread over seeds. The mean of these images is the unbiased
// reference.
double error_of_path(const Rendered& path) {
  double error = 0.0;
  for (size_t i = 0; i < path.moments.size(); ++i)
    error += seeds() * path.moments.variance_of_mean(i) * weight(path.moments, i);
  return error;
}

// Returns the error of one image against the mean of the path-traced images, less the error of that mean.
double error_against(const Rendered& path, const Rendered& rendered) {
  double error = 0.0;
  for (size_t i = 0; i < path.moments.size(); ++i) {
    double squares = 0.0;
    for (const auto& image : rendered.images) squares += std::pow(image[i] - path.moments.mean(i), 2) / seeds();
    error += (squares - path.moments.variance_of_mean(i)) * weight(path.moments, i);
  }
  return error;
}

TEST(B5_Benefit, DefaultIsBetterInTheSameTime) {
  int better = 0;
  for (const Scenario scenario : kScenarios) {
    test::PathScene scene;
    test::build(scenario, &scene);
    const Rendered path = render(&scene, GRADUS_INTEGRATOR_PATH, 1000),
                   chosen = render(&scene, GRADUS_INTEGRATOR_AUTO, 2000);
    const double error = error_against(path, chosen) / error_of_path(path), time = chosen.seconds / path.seconds;
    std::printf(
        "  %-12s %s: relMSE %.2f of path tracing at the same samples, %.2f of its time: %.2f at the same time\n",
        test::name_of(scenario), chosen.integrator.c_str(), error, time, error * time);
    better += error * time < 1.0 ? 1 : 0;
    EXPECT_LT(error * time, 1.5) << test::name_of(scenario);
  }
  EXPECT_GE(better, 4);
}

}  // namespace
}  // namespace gradus::benefit_test
