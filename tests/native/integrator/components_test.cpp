// Each path is counted in its component, and the components add up to the film of a single component.
#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"

namespace gradus::components_test {
namespace {

using test::PathScene;
using test::Scenario;

constexpr uint32_t kSide = 24;
// A set by the number of bounces, so that paths change their component at every vertex.
const char* const kByBounces = "Seen=EL;Once=E.L;Twice=E..L;Thrice=E...L";

// Samples a film with room for gradients, in which plain paths have the jitter of gradient paths.
film::Film sampled(const integrator::IntegratorContext& context, bool gradients, uint32_t samples = 6) {
  film::Film film = test::make_test_film(context.settings, true, context.components.count());
  const auto integrator =
      gradients ? gradient::make_gradient_integrator(context) : integrator::make_path_integrator(context);
  test::sample_film(*integrator, 0, samples, &film);
  return film;
}

struct Sums {
  Radiance sum = Radiance(0.0f), magnitude = Radiance(0.0f);
};

template <class PlaneOf>
Sums sums_at(const film::Film& film, size_t pixel, const PlaneOf& plane_of) {
  Sums s;
  for (const film::ComponentPlanes& planes : film.components) {
    const Radiance value = plane_of(planes)[pixel];
    s.sum += value;
    s.magnitude += glm::abs(value);
  }
  return s;
}

// Expects planes to be equal up to the order of additions. `scale`: of the largest terms.
template <class PlaneOf>
void expect_same_sums(const film::Film& one, const film::Film& many, float scale, const PlaneOf& plane_of) {
  size_t pixels = 0;
  float worst = 0.0f;
  for (size_t i = 0; i < size_t(one.region.area()); ++i) {
    const Sums whole = sums_at(one, i, plane_of), parts = sums_at(many, i, plane_of);
    const Radiance off = glm::abs(whole.sum - parts.sum) / (parts.magnitude + scale);
    worst = std::max({worst, off.x, off.y, off.z, off.w});
    pixels += whole.magnitude != Radiance(0.0f) ? 1 : 0;
  }
  EXPECT_LT(worst, 1e-5f);
  EXPECT_GT(pixels, size_t(one.region.area()) / 8);
}

float largest(const std::vector<Radiance>& plane) {
  float maximum = 0.0f;
  for (const Radiance& r : plane) maximum = std::max({maximum, std::fabs(r.x), std::fabs(r.y), std::fabs(r.z)});
  return maximum;
}

class Scenarios : public testing::TestWithParam<int> {
 protected:
  Scenario scenario() const { return Scenario(GetParam()); }
  integrator::IntegratorContext context(const char* components) {
    scene_ = std::make_unique<PathScene>();
    test::build(scenario(), scene_.get());
    GradusSettings settings = test::test_settings(kSide, kSide);
    settings.film_transparent = scenario() == Scenario::World ? 1 : 0;
    settings.clamp_indirect = scenario() == Scenario::GlossyFloor ? 2.0f : 0.0f;
    integrator::IntegratorContext context = scene_->context(settings);
    if (components != nullptr) context.components = lpe::ComponentSet::parse(components);
    return context;
  }
  std::unique_ptr<PathScene> scene_;
};

TEST_P(Scenarios, SumsOfComponentsAreThoseOfOnePlane) {
  const film::Film one = sampled(context(nullptr), true);
  for (const char* set : {"", kByBounces}) {
    const film::Film many = sampled(context(set), true);
    EXPECT_EQ(one.count, many.count);
    EXPECT_EQ(one.pair_count, many.pair_count);
    EXPECT_EQ(one.counters.rays_shift, many.counters.rays_shift);
    for (int half = 0; half < film::kHalves; ++half) {
      const float scale = largest(one.components[0].primal[half]);
      expect_same_sums(
          one, many, scale, [=](const film::ComponentPlanes& p) -> const auto& { return p.primal[half]; });
      for (int k = 0; k < film::kOffsets; ++k) {
        expect_same_sums(
            one, many, scale, [=](const film::ComponentPlanes& p) -> const auto& { return p.gradient[half][k]; });
      }
    }
  }
}

TEST_P(Scenarios, PlainPathsHaveTheSameComponents) {
  const integrator::IntegratorContext c = context("");
  const film::Film plain = sampled(c, false), with_gradients = sampled(c, true);
  for (size_t i = 0; i < plain.components.size(); ++i) {
    for (int half = 0; half < film::kHalves; ++half) {
      EXPECT_EQ(plain.components[i].primal[half], with_gradients.components[i].primal[half])
          << c.components[int(i)].name;
    }
  }
}

// Replays sample a component separately if it has displacements of its own.
TEST_P(Scenarios, ComponentsSampledSeparatelyHaveTheBitsOfThoseSampledTogether) {
  const integrator::IntegratorContext c = context("");
  const film::Film whole = sampled(c, true);
  film::Film separate = test::make_test_film(c.settings, true, c.components.count());
  const auto integrator = gradient::make_gradient_integrator(c);
  const uint32_t own = 1u << c.components.find("Diffuse") | 1u << c.components.find("Reflection");
  // A separate replay in every other pixel.
  const size_t pixels = size_t(separate.region.area());
  std::vector<uint32_t> shared(pixels, lpe::kEveryComponent);
  std::vector<uint8_t> map(pixels, 0);
  for (size_t i = 0; i < pixels; i += 2) shared[i] &= ~own, map[i] = 1;
  integrator::WorkUnit unit{separate.region, 0, 6};
  unit.component_map = &shared;
  integrator->sample(unit, &separate, &separate.counters, std::atomic<bool>{false});
  unit.component_map = nullptr;
  unit.adds_components = true;
  unit.pixel_map = &map;
  for (const char* name : {"Diffuse", "Reflection"}) {
    unit.components = 1u << c.components.find(name);
    integrator->sample(unit, &separate, &separate.counters, std::atomic<bool>{false});
  }
  EXPECT_EQ(whole.count, separate.count);
  EXPECT_EQ(whole.pair_count, separate.pair_count);
  for (size_t i = 0; i < whole.components.size(); ++i) {
    for (int half = 0; half < film::kHalves; ++half) {
      EXPECT_EQ(whole.components[i].primal[half], separate.components[i].primal[half]) << c.components[int(i)].name;
      for (int k = 0; k < film::kOffsets; ++k)
        EXPECT_EQ(whole.components[i].gradient[half][k], separate.components[i].gradient[half][k]);
    }
  }
}

TEST_P(Scenarios, PathsThatCanReachNoWantedComponentEnd) {
  const integrator::IntegratorContext c = context("");
  film::Film whole = sampled(c, false), seen = test::make_test_film(c.settings, true, c.components.count());
  const auto integrator = integrator::make_path_integrator(c);
  integrator::WorkUnit unit{seen.region, 0, 6};
  unit.components = 1u << c.components.find("Emission");
  integrator->sample(unit, &seen, &seen.counters, std::atomic<bool>{false});
  EXPECT_EQ(seen.components[0].primal, whole.components[0].primal);
  EXPECT_EQ(seen.counters.rays_bounce, 0u);
  EXPECT_GT(whole.counters.rays_bounce, 0u);
}

INSTANTIATE_TEST_SUITE_P(Components, Scenarios, testing::Range(0, int(Scenario::Count)),
                         [](const auto& info) { return test::name_of(Scenario(info.param)); });

double light_of(const film::Film& film, int component) {
  double sum = 0.0;
  for (const auto& half : film.components[size_t(component)].primal) {
    for (const Radiance& r : half) sum += double(r.x) + r.y + r.z;
  }
  return sum;
}

TEST(Components, AlphaBelongsToWhatTheCameraSees) {
  PathScene scene;
  test::build(Scenario::World, &scene);
  GradusSettings settings = test::test_settings(kSide, kSide);
  settings.film_transparent = 1;
  integrator::IntegratorContext context = scene.context(settings);
  context.components = lpe::ComponentSet::parse("");
  const film::Film film = sampled(context, true);
  const int seen = context.components.find("Emission");
  float maximum = 0.0f;
  for (int c = 0; c < context.components.count(); ++c) {
    for (const Radiance& r : film.components[size_t(c)].primal[0]) {
      if (c == seen) {
        maximum = std::max(maximum, r.w);
      } else {
        ASSERT_EQ(r.w, 0.0f) << context.components[c].name;
      }
    }
  }
  EXPECT_EQ(maximum, 3.0f);
}

TEST(Components, AMirrorShowsReflectionsAndNoEmission) {
  PathScene scene;
  test::Surface light;
  light.emission = Rgb(2.0f);
  const uint64_t mirror = scene.material(test::glossy(0.0f));
  scene.quad(Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), mirror);
  scene.quad(Vec3(-8, -8, 6), Vec3(0, 16, 0), Vec3(16, 0, 0), scene.material(light),
             GRADUS_VISIBLE_ALL & ~uint32_t(GRADUS_VISIBLE_CAMERA));
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  integrator::IntegratorContext context = scene.context(test::test_settings(kSide, kSide));
  context.components = lpe::ComponentSet::parse("");
  const film::Film film = sampled(context, true);
  for (int c = 0; c < context.components.count(); ++c) {
    EXPECT_EQ(light_of(film, c) > 0.0, context.components[c].name == "Reflection") << context.components[c].name;
  }
}

}  // namespace
}  // namespace gradus::components_test
