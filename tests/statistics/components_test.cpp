// Compares components with an independent path tracer that spells out the light path of every sample, and their
// gradients with differences of their images.
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/bsdf_only.h"
#include "support/difference_statistics.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::components_test {
namespace {

using test::PathScene;
using test::Scenario;

constexpr uint32_t kSide = 20;

// Builds a floor with a matte and a glossy lobe below a large light, with one ball of glass and one of rough metal.
void build_mixed(PathScene* scene) {
  test::Surface floor = test::matte(Rgb(0.5f));
  floor.glossy = Rgb(0.3f);
  floor.glossy_roughness = 0.1f;
  test::add_box(scene, floor);
  test::add_ceiling_light(scene, 1.5f, 1.6f);
  scene->ball(Vec3(-0.4f, -0.5f, 0.1f), 0.45f, scene->material(test::glass(0.0f)), 10, true);
  scene->ball(Vec3(0.45f, -0.5f, 0.2f), 0.45f, scene->material(test::glossy(0.5f)), 10, true);
}

// Returns the mean over pixels and channels of each component.
std::vector<float> means(const film::Film& film) {
  std::vector<float> result;
  for (int c = 0; c < int(film.components.size()); ++c) {
    double sum = 0.0;
    for (const float value : film::read_images(film, c).primal) sum += value;
    result.push_back(float(sum / double(film.region.area() * 3)));
  }
  return result;
}

TEST(Components, HaveTheMeansThatAnIndependentTracerFinds) {
  PathScene scene;
  build_mixed(&scene);
  GradusSettings settings = test::test_settings(kSide, kSide);
  settings.max_bounces = 5;
  for (const char* text : {"", "Caustic=ED+(R|T)(.)*L;Direct=EDL;ThroughGlass=ET+D.*L"}) {
    integrator::IntegratorContext context = scene.context(settings);
    context.components = lpe::ComponentSet::parse(text);
    const lpe::ComponentSet& set = context.components;
    test::Moments ours, truth;
    for (uint32_t seed = 0; seed < 48; ++seed) {
      context.settings.seed = seed;
      film::Film film = test::make_test_film(settings, true, set.count());
      test::sample_film(*gradient::make_gradient_integrator(context), 0, 16, &film);
      ours.add(means(film));
      test::Random random(seed + 1);
      std::vector<double> sums(size_t(set.count()), 0.0);
      constexpr int kSamples = 64;
      for (int i = 0; i < kSamples * int(kSide * kSide); ++i) {
        const int x = i % int(kSide), y = i / int(kSide) % int(kSide);
        test::bsdf_only_path(context, x, y, &random, [&](const std::string& path, const Rgb& light) {
          sums[size_t(set.classify(path))] += double(light.x) + light.y + light.z;
        });
      }
      std::vector<float> image;
      for (const double sum : sums) image.push_back(float(sum / (3.0 * kSamples * kSide * kSide)));
      truth.add(image);
    }
    for (int c = 0; c < set.count(); ++c) {
      const size_t i = size_t(c);
      EXPECT_GT(truth.mean(i), 1e-4) << set[c].name;  // The component must contain light.
      if (truth.variance_of_mean(i) > 1e-12) {
        EXPECT_GT(test::welch_p(ours, truth, i), 1e-3)
            << set[c].name << ": " << ours.mean(i) << " and " << truth.mean(i);
      } else {
        EXPECT_NEAR(ours.mean(i), truth.mean(i), 1e-4) << set[c].name;
      }
      std::printf("  %s %.5f, truth %.5f ± %.5f\n", set[c].name.c_str(), ours.mean(i), truth.mean(i),
                  std::sqrt(truth.variance_of_mean(i)));
    }
  }
}

struct PartitionCase {
  Scenario scenario;
  const char* components;
  std::vector<const char*> checked;
};

TEST(Components, HaveGradientsThatAreDifferencesOfTheirImages) {
  const char* const by_bounces = "Once=E.L;Twice=E..L";
  const PartitionCase cases[] = {{Scenario::DiffuseArea, by_bounces, {"Once", "Twice", "Residual"}},
                                 {Scenario::GlossyFloor, "", {"Diffuse", "Reflection"}},
                                 {Scenario::Mirror, "", {"Diffuse", "Reflection"}},
                                 {Scenario::Glass, "", {"Diffuse", "Transmission", "Residual"}},
                                 {Scenario::RoughGlass, by_bounces, {"Once", "Twice", "Residual"}},
                                 {Scenario::Transparent, by_bounces, {"Once", "Twice", "Residual"}}};
  for (const PartitionCase& c : cases) {
    PathScene scene;
    test::build(c.scenario, &scene);
    integrator::IntegratorContext context = scene.context(test::test_settings(kSide, kSide));
    context.components = lpe::ComponentSet::parse(c.components);
    std::vector<test::BothDirections> differences(c.checked.size());
    for (uint32_t seed = 0; seed < 24; ++seed) {
      context.settings.seed = 100 + seed;
      film::Film film = test::make_test_film(context.settings, true, context.components.count());
      test::sample_film(*gradient::make_gradient_integrator(context), 0, 24, &film);
      for (size_t i = 0; i < c.checked.size(); ++i) {
        differences[i].add(film::read_images(film, context.components.find(c.checked[i])));
      }
    }
    for (size_t i = 0; i < c.checked.size(); ++i) {
      std::printf("  %s, %s\n", test::name_of(c.scenario), c.checked[i]);
      differences[i].check();
    }
  }
}

}  // namespace
}  // namespace gradus::components_test
