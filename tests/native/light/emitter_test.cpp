// A4 for lights: densities of points are the same however they were sampled; the choice among many lights.
#include <gtest/gtest.h>

#include "light/light_sampling.h"
#include "light/light_table.h"
#include "scene/scene_fixture.h"

namespace gradus::test::emitter_test {
namespace {

Mat4 random_pose(std::mt19937& random, float extent) {
  std::uniform_real_distribution<float> u(-extent, extent);
  const Vec3 z = random_direction(random);
  const Vec3 x = glm::normalize(glm::cross(z, std::fabs(z.x) > 0.5f ? Vec3(0, 1, 0) : Vec3(1, 0, 0)));
  const float a = u(random), b = u(random);
  return Mat4(Vec4(x, 0), Vec4(glm::cross(z, x), 0), Vec4(z, 0), Vec4(a, b, u(random), 1));
}

std::vector<GradusLight> random_lights(std::mt19937& random, int count, bool dirac) {
  std::uniform_real_distribution<float> u(0.1f, 2.0f);
  std::vector<GradusLight> lights;
  for (int i = 0; i < count; ++i) {
    GradusLight light = make_light(GradusLightType(i % 5), random_pose(random, 5.0f), Rgb(u(random)));
    light.radius = dirac ? 0.0f : 0.3f * u(random);
    light.angle = dirac ? 0.0f : 0.2f * u(random);
    light.size[0] = u(random);
    light.size[1] = u(random);
    if (i % 10 == 1) light.flags = GRADUS_LIGHT_DISK_FACING;
    if (i % 10 == 3) light.spread = 1.5f;
    lights.push_back(light);
  }
  return lights;
}

// Returns a scene with lights of all kinds, an emissive sphere and a world.
std::shared_ptr<const scene::Snapshot> mixed_scene(int analytic_lights) {
  std::mt19937 random(11);
  TestScene scene;
  scene.lights(random_lights(random, analytic_lights, false));
  scene.mesh(1, sphere(Vec3(2, 1, 0), 0.5f, 8, 12));
  scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), 5.0f));
  scene.material(6, MaterialDesc::colored_by_generated());
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 5);
  scene.world(6, 64);
  return scene.commit();
}

light::Receiver random_receiver(std::mt19937& random) {
  std::uniform_real_distribution<float> u(-6.0f, 6.0f);
  const float x = u(random), y = u(random);
  return {Vec3(x, y, u(random)), random_direction(random), (random() & 3) == 0};
}

TEST(A4_LightDensity, SampledPointsHaveADensity) {
  const auto snapshot = mixed_scene(20);
  std::mt19937 random(12);
  std::uniform_real_distribution<float> u(0.0f, 0.9999999f);
  int sampled = 0, without = 0;
  for (int i = 0; i < 100000; ++i) {
    const light::Receiver receiver = random_receiver(random);
    const float choice = u(random), x = u(random), y = u(random);
    light::LightPoint point;
    light::LightEvaluation at_once;
    light::sample_light_point(*snapshot, receiver, choice, Vec2(x, y), &point, &at_once);
    if (point.kind == light::LightKind::None) continue;
    const light::LightEvaluation view = light::evaluate_light(*snapshot, point, receiver);
    ++sampled;
    without += !(view.pdf > 0.0f);
    EXPECT_EQ(view.pdf, at_once.pdf);
    EXPECT_EQ(view.pdf, light::light_point_pdf(*snapshot, point, receiver));
    EXPECT_GE(view.pdf, 0.0f);
  }
  EXPECT_GT(sampled, 50000);
  // The exceptions are rounding at the rim of a sphere and at grazing angles.
  EXPECT_LE(without, sampled / 10000);
}

// A ray in the sampled direction meets the same point with the same density; otherwise MIS weights would not sum to
// one.
TEST(A4_LightDensity, PointsMetByRaysHaveTheSameDensity) {
  const auto snapshot = mixed_scene(40);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> u(0.0f, 0.9999999f);
  int compared = 0, different = 0, displaced = 0, missed = 0;
  for (int i = 0; i < 100000; ++i) {
    const light::Receiver receiver = random_receiver(random);
    const float choice = u(random), x = u(random);
    light::LightPoint point;
    light::LightEvaluation sampled_view;
    light::sample_light_point(*snapshot, receiver, choice, Vec2(x, u(random)), &point, &sampled_view);
    if (point.kind != light::LightKind::AnalyticLight || point.dirac) continue;
    const light::LightEvaluation view = light::evaluate_light(*snapshot, point, receiver);
    if (!(view.pdf > 0.0f)) continue;
    std::vector<light::LightHit> hits;
    light::intersect_lights(*snapshot, {receiver.position, 0.0f, view.direction, kInfinity}, &hits);
    const light::LightHit* met = nullptr;
    for (size_t k = 0; k < hits.size(); ++k) {
      if (hits[k].point.index == point.index) met = &hits[k];
      if (k > 0) {
        EXPECT_LE(hits[k - 1].distance, hits[k].distance);
      }
    }
    ++compared;
    if (!met) {
      ++missed;
      continue;
    }
    const light::LightEvaluation again = light::evaluate_light(*snapshot, met->point, receiver);
    different += std::fabs(again.pdf - view.pdf) > 1e-4f * view.pdf;
    if (view.distance != kInfinity)
      displaced += std::fabs(met->distance - view.distance) > 1e-3f * view.distance + 1e-4f;
  }
  EXPECT_GT(compared, 20000);
  EXPECT_LE(missed, compared / 2000);  // at rims
  EXPECT_LE(displaced, compared / 2000);
  EXPECT_LE(different, compared / 1000);
}

TEST(A4_LightDensity, TriangleMetByRay) {
  const auto snapshot = mixed_scene(0);
  std::mt19937 random(14);
  int met = 0;
  for (int i = 0; i < 1000; ++i) {
    const light::Receiver receiver{Vec3(0, 0, 3), Vec3(0, 0, -1), true};
    const Vec3 direction = glm::normalize(Vec3(2, 1, 0) + 0.5f * random_direction(random) - receiver.position);
    geometry::Hit hit;
    if (!snapshot->intersect({receiver.position, 0.0f, direction, kInfinity}, GRADUS_VISIBLE_CAMERA, &hit)) continue;
    const light::LightPoint point = light::light_point_of_surface(*snapshot, snapshot->surface_point(hit));
    ASSERT_EQ(point.kind, light::LightKind::Triangle);
    const light::LightEvaluation view = light::evaluate_light(*snapshot, point, receiver);
    EXPECT_GT(view.pdf, 0.0f);
    EXPECT_NEAR(view.radiance.x, 5.0f, 1e-5f);
    EXPECT_NEAR(view.distance, hit.t, 1e-4f);
    // Seen from there, only the emitter itself lies between, and it must not shadow itself.
    geometry::SurfacePoint from;
    from.position = receiver.position;
    from.geometric_normal = receiver.normal;
    EXPECT_FALSE(
        snapshot->occluded(light::ray_to_light(geometry::offset_origin(from, view.direction), from, point, view)));
    ++met;
  }
  EXPECT_GT(met, 500);
}

double probability_sum(const light::LightTable& table, const light::Receiver& receiver) {
  light::LightChoice room;
  const light::GroupChoice group = table.choose(receiver, &room).group;
  double sum = group.world;
  for (size_t i = 0; i < table.suns.size(); ++i) sum += group.suns * table.sun_probability(i, receiver);
  for (uint32_t i = 0; i < table.tree.size(); ++i) sum += group.tree * table.tree.probability(i, receiver);
  return sum;
}

TEST(A4_LightChoice, ProbabilitiesSumToOne) {
  const auto snapshot = mixed_scene(1000);
  std::mt19937 random(15);
  for (int i = 0; i < 200; ++i)
    EXPECT_NEAR(probability_sum(*snapshot->light_table, random_receiver(random)), 1.0,
                4.0 * std::numeric_limits<float>::epsilon());
}

// One memo serves receivers that differ in position, side or transmission: it must not return the values of another
// receiver.
TEST(A4_LightChoice, MemoChangesNoBit) {
  const auto snapshot = mixed_scene(60);
  std::mt19937 random(16);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  light::LightChoice memo;
  for (int i = 0; i < 100; ++i) {
    light::Receiver receiver = random_receiver(random);
    for (const float side : {1.0f, -1.0f}) {
      for (const bool transmits : {false, true}) {
        receiver.normal *= side;
        receiver.transmits = transmits;
        light::Receiver with_memo = receiver;
        with_memo.memo = &memo;
        const float choice = uniform(random);
        const Vec2 u(uniform(random), uniform(random));
        light::LightPoint point, same_point;
        light::LightEvaluation view, same_view;
        light::sample_light_point(*snapshot, receiver, choice, u, &point, &view);
        light::sample_light_point(*snapshot, with_memo, choice, u, &same_point, &same_view);
        ASSERT_EQ(point.kind, same_point.kind);
        ASSERT_EQ(point.index, same_point.index);
        ASSERT_EQ(view.pdf, same_view.pdf);
        ASSERT_EQ(light::light_point_pdf(*snapshot, point, receiver),
                  light::light_point_pdf(*snapshot, point, with_memo));
      }
    }
  }
}

TEST(A4_LightChoice, FrequenciesFollowProbabilities) {
  const auto snapshot = mixed_scene(60);
  const light::LightTable& table = *snapshot->light_table;
  std::mt19937 random(16);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int k = 0; k < 5; ++k) {
    const light::Receiver receiver = random_receiver(random);
    constexpr int kCount = 200000;
    double probability;
    std::vector<int> frequency(table.tree.size());
    for (int i = 0; i < kCount; ++i) ++frequency[table.tree.sample(receiver, u(random), &probability)];
    double chi2 = 0.0;
    int cells = 0;
    for (uint32_t i = 0; i < frequency.size(); ++i) {
      const double expected = table.tree.probability(i, receiver) * kCount;
      if (expected < 1e-9) {
        EXPECT_EQ(frequency[i], 0);
      }
      if (expected < 5.0) continue;
      chi2 += (frequency[i] - expected) * (frequency[i] - expected) / expected;
      ++cells;
    }
    ASSERT_GT(cells, 5);
    // The statistic has the mean `cells` and the variance 2·cells: the bound is five standard deviations.
    EXPECT_LT(chi2, cells + 5.0 * std::sqrt(2.0 * cells));
  }
}

// Evenly spaced numbers meet each light as often as its probability says, and sample() writes the bits of
// probability(). The numbers of lights are those around full and partly filled nodes of one, two and three levels.
TEST(A4_LightChoice, SamplesAgreeWithProbabilities) {
  std::mt19937 random(18);
  for (const uint32_t lights : {1u, 2u, 7u, 8u, 9u, 20u, 63u, 65u, 600u}) {
    std::vector<light::LightBounds> bounds(lights);
    for (uint32_t i = 0; i < lights; ++i) {
      light::AnalyticLight light;
      light::make_analytic_light(random_lights(random, 4, false)[i % 4], Vec3(0.0f), &light);
      bounds[i] = light::light_bounds(light);
    }
    light::LightTree tree;
    tree.build(bounds, [] { return false; });
    ASSERT_EQ(tree.size(), lights);
    for (int k = 0; k < 20; ++k) {
      const light::Receiver receiver = random_receiver(random);
      const light::LightTree::Cut cut = tree.cut(receiver);
      constexpr int kCount = 20000;
      std::vector<int> frequency(lights);
      for (int i = 0; i < kCount; ++i) {
        double probability;
        const uint32_t light = tree.sample(receiver, cut, (i + 0.5) / kCount, &probability);
        ASSERT_EQ(probability, tree.probability(light, receiver, cut));
        ++frequency[light];
      }
      double sum = 0.0;
      for (uint32_t i = 0; i < lights; ++i) {
        const double probability = tree.probability(i, receiver, cut);
        EXPECT_NEAR(frequency[i], probability * kCount, 1.01);
        sum += probability;
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
    }
  }
}

// Up to eight lights are chosen by their own bounds, a tenth of the samples equally.
TEST(A4_LightChoice, FewLightsAreChosenByTheirIrradiance) {
  std::mt19937 random(19);
  for (int lights = 2; lights <= 8; ++lights) {
    std::vector<light::LightBounds> bounds;
    for (int i = 0; i < lights; ++i) {
      light::AnalyticLight light;
      light::make_analytic_light(make_light(GRADUS_LIGHT_POINT, random_pose(random, 5.0f), Rgb(float(i + 1))),
                                 Vec3(0.0f), &light);
      bounds.push_back(light::light_bounds(light));
    }
    light::LightTree tree;
    tree.build(bounds, [] { return false; });
    const light::Receiver receiver{random_receiver(random).position, Vec3(0.0f), false};
    std::vector<double> irradiance;
    double sum = 0.0;
    for (const light::LightBounds& b : bounds) {
      const Vec3 d = b.lower - receiver.position;
      irradiance.push_back(double(b.power) / double(glm::dot(d, d)));
      sum += irradiance.back();
    }
    EXPECT_NEAR(tree.cut(receiver).irradiance() / sum, 1.0, 1e-5);
    for (int i = 0; i < lights; ++i)
      EXPECT_NEAR(tree.probability(uint32_t(i), receiver), 0.9 * irradiance[size_t(i)] / sum + 0.1 / lights, 1e-5);
  }
}

// E4: the variance with 10,000 lights is below that of uniform choice.
TEST(E4_ManyLights, TreeBeatsUniformChoice) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> u(-50.0f, 50.0f), v(0.0f, 0.9999999f);
  std::vector<GradusLight> lights;
  for (int i = 0; i < 10000; ++i) {
    const float x = u(random), y = u(random);
    lights.push_back(make_light(GRADUS_LIGHT_POINT, translation(Vec3(x, y, 3.0f + 0.02f * u(random))), Rgb(1.0f)));
  }
  TestScene scene;
  scene.lights(lights);
  const auto snapshot = scene.commit();
  double tree = 0.0, uniform = 0.0, exact_sum = 0.0, mean_sum = 0.0;
  for (int k = 0; k < 20; ++k) {
    const light::Receiver receiver{Vec3(0.5f * u(random), 0.5f * u(random), 0), Vec3(0, 0, 1), false};
    const auto value = [&](uint32_t i) {
      const Vec3 d = snapshot->light_table->analytic_lights[i].position - receiver.position;
      return double(d.z) / std::pow(double(glm::dot(d, d)), 1.5);
    };
    double exact = 0.0, squares = 0.0;
    for (uint32_t i = 0; i < 10000; ++i) exact += value(i), squares += value(i) * value(i);
    double mean = 0.0, second = 0.0;
    constexpr int kCount = 2000;
    for (int i = 0; i < kCount; ++i) {
      light::LightPoint point;
      light::LightEvaluation sampled_view;
      light::sample_light_point(*snapshot, receiver, v(random), Vec2(0.5f), &point, &sampled_view);
      const light::LightEvaluation view = light::evaluate_light(*snapshot, point, receiver);
      const double x = view.radiance.x * view.direction.z / view.pdf;
      mean += x / kCount;
      second += x * x / kCount;
    }
    exact_sum += exact;
    mean_sum += mean;
    tree += (second - mean * mean) / (exact * exact);
    uniform += (squares * 10000 - exact * exact) / (exact * exact);
  }
  EXPECT_NEAR(mean_sum / exact_sum, 1.0, 0.02);
  EXPECT_LT(tree, 0.02 * uniform);  // 0.14 without the bound of the tree
}

// A hundred thousand triangles: small balls that float in a room, with materials of three strengths.
std::shared_ptr<const scene::Snapshot> emissive_balls(std::mt19937* random) {
  std::uniform_real_distribution<float> x(-5.0f, 5.0f), z(0.5f, 3.0f), radius(0.02f, 0.1f);
  TestScene scene;
  for (uint64_t kind = 0; kind < 3; ++kind) {
    Soup soup;
    while (soup.vertices.size() < 3 * 33400) {
      const Vec3 centre(x(*random), x(*random), z(*random));
      const float r = radius(*random);
      constexpr int kRings = 8;
      const auto at = [&](int i, int j) {
        const float theta = kPi * float(i) / kRings, phi = kPi * float(j) / kRings;
        return centre + r * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      };
      for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < 2 * kRings; ++j) {
          if (i > 0) soup.triangle(at(i, j), at(i + 1, j), at(i, j + 1));
          if (i + 1 < kRings) soup.triangle(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
        }
    }
    scene.mesh(kind + 1, soup);
    scene.material(10 + kind, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), std::pow(4.0f, float(kind))));
    scene.instance(kind + 1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 10 + kind);
  }
  return scene.commit();
}

struct Spread {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  double mean() const { return sum / count; }
  double variance() const { return squares / count - mean() * mean(); }
};

// Returns the irradiance without shadows, by uniform choice of a triangle and of a point on it.
double by_uniform_choice(const scene::Snapshot& snapshot, const light::Receiver& receiver, std::mt19937* random) {
  std::uniform_real_distribution<float> u(0.0f, 0.9999999f);
  const std::vector<light::EmissiveTriangle>& all = snapshot.light_table->triangles;
  const light::EmissiveTriangle& triangle = all[size_t(u(*random) * float(all.size()))];
  const float root = std::sqrt(u(*random));
  geometry::Hit hit;
  hit.instance = triangle.instance;
  hit.primitive = triangle.triangle;
  hit.uv = Vec2(1.0f - root, u(*random) * root);
  const light::LightPoint point = light::light_point_of_surface(snapshot, snapshot.surface_point(hit));
  const light::LightEvaluation view = light::evaluate_light(snapshot, point, receiver);
  const double cosine = std::max(double(glm::dot(receiver.normal, view.direction)), 0.0);
  return view.radiance.x * cosine * double(view.cosine) * double(triangle.area) * double(all.size()) /
         (double(view.distance) * double(view.distance));
}

TEST(E4_ManyLights, HundredThousandTrianglesAreBetterChosenThanUniformly) {
  std::mt19937 random(18);
  const auto snapshot = emissive_balls(&random);
  ASSERT_GE(snapshot->light_table->triangles.size(), 100000u);
  std::uniform_real_distribution<float> x(-5.0f, 5.0f), u(0.0f, 0.9999999f);
  double tree = 0.0, uniform = 0.0, ratio = 0.0;
  constexpr int kReceivers = 10;
  for (int k = 0; k < kReceivers; ++k) {
    const light::Receiver receiver{Vec3(x(random), x(random), 0.0f), Vec3(0, 0, 1), false};
    Spread by_tree, by_chance;
    for (int i = 0; i < 10000; ++i) {
      light::LightPoint point;
      light::LightEvaluation view;
      const Vec2 at(u(random), u(random));
      light::sample_light_point(*snapshot, receiver, u(random), at, &point, &view);
      by_tree.add(view.pdf > 0.0f ? double(view.radiance.x * std::max(view.direction.z, 0.0f) / view.pdf) : 0.0);
    }
    for (int i = 0; i < 100000; ++i) by_chance.add(by_uniform_choice(*snapshot, receiver, &random));
    ratio += by_tree.mean() / by_chance.mean() / kReceivers;
    tree += by_tree.variance() / (by_tree.mean() * by_tree.mean()) / kReceivers;
    uniform += by_chance.variance() / (by_tree.mean() * by_tree.mean()) / kReceivers;
  }
  EXPECT_NEAR(ratio, 1.0, 0.05);
  EXPECT_LT(tree, 0.05 * uniform);
  EXPECT_LT(tree, 1.0);
  std::printf("  relative variance %.3f, by uniform choice %.1f\n", tree, uniform);
}

}  // namespace
}  // namespace gradus::test::emitter_test
