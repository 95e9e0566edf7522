// Walks in a half-space and in a slab against the theory of radiative transfer.
#include "path/random_walk.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "path/burley_disk.h"
#include "support/chi_square.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::random_walk_test {
namespace {

using test::PathScene;

// Returns Chandrasekhar's H function of isotropic scattering at `cosine` (Radiative Transfer, 1960, ch. V), by
// iteration of its integral equation.
double h_function(double albedo, double cosine) {
  constexpr int n = 200;
  std::vector<double> h(n, 1.0);
  const auto node = [](int i) { return (i + 0.5) / n; };
  const auto next = [&](double mu) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += node(i) * h[size_t(i)] / (mu + node(i)) / n;
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * sum);
  };
  for (int k = 0; k < 200; ++k) {
    std::vector<double> better(n);
    for (int i = 0; i < n; ++i) better[size_t(i)] = next(node(i));
    h = better;
  }
  return next(cosine);
}

// A half-space below the plane z = 0, or a slab of a thickness.
struct Space {
  static void add_plane(float z, test::Soup* soup) {
    const Vec3 a(-1e4f, -1e4f, z), b(1e4f, -1e4f, z), c(1e4f, 1e4f, z), d(-1e4f, 1e4f, z);
    soup->triangle(a, b, c);
    soup->triangle(a, c, d);
  }

  PathScene scene;
  integrator::IntegratorContext integrator;

  explicit Space(float thickness = 0.0f) {
    const uint64_t surface = scene.material(test::matte(Rgb(0.5f)));
    test::Soup soup;
    add_plane(0.0f, &soup);
    if (thickness > 0.0f) add_plane(-thickness, &soup);
    scene.scene.mesh(100, soup);
    scene.scene.instance(100, Mat4(1.0f), GRADUS_VISIBLE_ALL, surface);
    scene.camera(Vec3(0, 0, 5), Vec3(0.0f), 1.0f);
    integrator = scene.context(test::test_settings(4, 4));
  }
};

struct Mean {
  Rgb value = Rgb(0.0f), error = Rgb(0.0f);
};

// Returns the mean weight of walks that enter at the origin in a direction and leave by the plane z = 0, or anywhere.
Mean reflectance(const Space& space, const bsdf::Medium& medium, const Vec3& direction, int walks, bool anywhere) {
  const path::PathContext context(*space.integrator.snapshot, space.integrator.camera, space.integrator.settings);
  path::WalkStart start;
  start.position = Vec3(0, 0, -1e-4f);
  start.direction = direction;
  Rgb sum(0.0f), squares(0.0f);
  for (int i = 0; i < walks; ++i) {
    path::SampleKey key;
    key.index = uint32_t(i);
    const path::Sampler sampler(key, true);
    Rgb weight(1.0f);
    path::WalkEnd end;
    if (!path::walk(context, sampler, 0, medium, start, &weight, &end)) continue;
    if (!anywhere && end.direction.z < 0.0f) continue;
    sum += weight;
    squares += weight * weight;
  }
  const float n = float(walks);
  return {sum / n, glm::sqrt(glm::max(squares / n - sum * sum / (n * n), 0.0f) / n)};
}

bsdf::Medium medium_of(float albedo, float anisotropy = 0.0f) {
  bsdf::Medium medium;
  medium.extinction = Rgb(1.0f);
  medium.albedo = Rgb(albedo);
  medium.anisotropy = anisotropy;
  return medium;
}

const int kWalks = test::full_run() ? 400000 : 60000;

TEST(RandomWalk, AHalfSpaceReflectsAsMuchAsChandrasekharsFunctionSays) {
  const Space space;
  for (const float albedo : {0.3f, 0.7f, 0.95f}) {
    for (const float cosine : {1.0f, 0.4f}) {
      const Vec3 direction(std::sqrt(1.0f - cosine * cosine), 0.0f, -cosine);
      const Mean mean = reflectance(space, medium_of(albedo), direction, kWalks, true);
      const double expected = 1.0 - h_function(albedo, cosine) * std::sqrt(1.0 - albedo);
      std::printf("  albedo %.2f cosine %.1f: %.4f ± %.4f, expected %.4f\n", albedo, cosine, mean.value.x, mean.error.x,
                  expected);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean.value[c], expected, 4.0 * mean.error[c] + 2e-3);
    }
  }
}

TEST(RandomWalk, ASlabWithoutAbsorptionLosesNoEnergy) {
  const Space slab(4.0f);
  const Mean mean = reflectance(slab, medium_of(0.999999f), Vec3(0, 0, -1), kWalks, true);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean.value[c], 1.0f, 4.0f * mean.error[c] + 2e-3f);
}

TEST(RandomWalk, ChannelsOfEqualMediaAreEqual) {
  const Space space;
  const Mean mean = reflectance(space, medium_of(0.8f, 0.5f), Vec3(0, 0, -1), 2000, true);
  EXPECT_FLOAT_EQ(mean.value.x, mean.value.y);
  EXPECT_FLOAT_EQ(mean.value.y, mean.value.z);
}

TEST(RandomWalk, ChannelsOfUnequalMediaDoNotDisturbEachOther) {
  const Space space;
  bsdf::Medium medium = medium_of(0.9f);
  medium.extinction = Rgb(1.0f, 4.0f, 20.0f);
  medium.albedo = Rgb(0.9f, 0.6f, 0.3f);
  const Mean mean = reflectance(space, medium, Vec3(0, 0, -1), kWalks, true);
  for (int c = 0; c < 3; ++c) {
    const double expected = 1.0 - h_function(medium.albedo[c], 1.0) * std::sqrt(1.0 - medium.albedo[c]);
    EXPECT_NEAR(mean.value[c], expected, 4.0 * mean.error[c] + 2e-3);
  }
}

// The albedo of a half-space under diffuse light is that for which its medium was chosen, as precisely as the fits.
TEST(RandomWalk, TheMediumBelowASurfaceHasTheColorOfTheSurface) {
  const Space space;
  for (const bsdf::SubsurfaceMethod method :
       {bsdf::SubsurfaceMethod::WalkDiffuse, bsdf::SubsurfaceMethod::WalkDeHulst}) {
    bsdf::Lobe lobe;
    lobe.type = bsdf::LobeType::Subsurface;
    lobe.subsurface = method;
    lobe.f0 = lobe.weight = Rgb(0.2f, 0.5f, 0.8f);
    lobe.f90 = Rgb(1.0f);
    lobe.ior = 1.4f;
    Rgb weight;
    const bsdf::Medium medium = bsdf::medium_below(lobe, &weight);
    Rgb sum(0.0f);
    constexpr int kAngles = 8;
    for (int i = 0; i < kAngles; ++i) {  // equal parts of the cosine-weighted hemisphere
      const float cosine = std::sqrt((float(i) + 0.5f) / kAngles);
      sum += weight *
             reflectance(space, medium, Vec3(std::sqrt(1.0f - cosine * cosine), 0.0f, -cosine), kWalks / kAngles, true)
                 .value;
    }
    sum /= float(kAngles);
    std::printf("  method %d: %.4f %.4f %.4f\n", int(method), sum.x, sum.y, sum.z);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], lobe.f0[c], 0.06f * lobe.f0[c]);
  }
}

TEST(BurleyDisk, TheProfileIntegratesToOneAndSamplesFollowIt) {
  double sum = 0.0;
  for (int i = 0; i < 16000; ++i) sum += path::burley_profile(1.0f, (float(i) + 0.5f) * 1e-3f) * 1e-3;
  EXPECT_NEAR(sum, 1.0, 1e-3);
  for (const float u : {0.1f, 0.5f, 0.9f, 0.99f}) {
    const float r = path::sample_burley(u);
    double below = 0.0;
    for (int i = 0; i < 10000; ++i) below += path::burley_profile(1.0f, r * (float(i) + 0.5f) * 1e-4f) * r * 1e-4;
    EXPECT_NEAR(below, u, 2e-3);
  }
}

}  // namespace
}  // namespace gradus::random_walk_test
