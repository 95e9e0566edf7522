// Light linking in the choice among lights: lights that do not light the receiver's light set are not sampled, and are
// black where a ray finds them. Shadow linking: only surfaces in an emitter's shadow sets block it.
#include <cmath>

#include <gtest/gtest.h>

#include "light/light_sampling.h"
#include "light/light_table.h"
#include "scene/scene_fixture.h"

namespace gradus::test::light_links_test {
namespace {

constexpr uint32_t kSets = 4;

GradusLight light_at(const Vec3& position, uint64_t receivers) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(position), Rgb(1.0f));
  light.radius = 0.1f;
  light.receiver_mask = receivers;
  return light;
}

// Returns a scene of lights that light various sets, with suns, two emissive spheres and a world.
std::shared_ptr<const scene::Snapshot> linked_scene() {
  std::mt19937 random(21);
  std::uniform_real_distribution<float> u(-3.0f, 3.0f);
  TestScene scene;
  std::vector<GradusLight> lights;
  for (uint32_t i = 0; i < 40; ++i) {
    const float x = u(random), y = u(random);
    lights.push_back(light_at(Vec3(x, y, u(random)), i % 5 == 4 ? 0 : uint64_t{1} << i % kSets));
  }
  for (uint32_t i = 0; i < 3; ++i) {
    GradusLight sun = make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(1.0f));
    sun.angle = 0.1f;
    sun.receiver_mask = uint64_t{1} << i;
    lights.push_back(sun);
  }
  scene.lights(lights);
  scene.mesh(1, sphere(Vec3(2, 1, 0), 0.5f, 4, 6));
  scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), 5.0f));
  scene.material(6, MaterialDesc::colored_by_generated());
  scene.links.receiver_mask = 2;
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 5);
  scene.links.receiver_mask = 4 | 8;
  scene.instance(1, translation(Vec3(-4, 0, 0)), GRADUS_VISIBLE_ALL, 5);
  scene.world(6, 64);
  return scene.commit();
}

light::Receiver random_receiver(std::mt19937& random, uint64_t light_sets) {
  std::uniform_real_distribution<float> u(-5.0f, 5.0f);
  const float x = u(random), y = u(random);
  light::Receiver receiver{Vec3(x, y, u(random)), random_direction(random), (random() & 3) == 0};
  receiver.light_sets = light_sets;
  return receiver;
}

TEST(LightLinks, SampledPointsLightTheReceiver) {
  const auto snapshot = linked_scene();
  std::mt19937 random(22);
  std::uniform_real_distribution<float> u(0.0f, 0.9999999f);
  for (int i = 0; i < 40000; ++i) {
    const light::Receiver receiver = random_receiver(random, uint64_t{1} << i % kSets);
    const float choice = u(random), x = u(random), y = u(random);
    light::LightPoint point;
    light::LightEvaluation at_once;
    light::sample_light_point(*snapshot, receiver, choice, Vec2(x, y), &point, &at_once);
    if (point.kind == light::LightKind::None) continue;
    const bool lights = (light::links_of(*snapshot, point).receivers & receiver.light_sets) != 0;
    EXPECT_TRUE(lights || at_once.pdf == 0.0f);
    // Another receiver at the same place sees the point by its own light set.
    light::Receiver other = receiver;
    other.light_sets = uint64_t{1} << (i + 1) % kSets;
    const light::LightEvaluation view = light::evaluate_light(*snapshot, point, other);
    const bool lights_other = (light::links_of(*snapshot, point).receivers & other.light_sets) != 0;
    EXPECT_EQ(view.is_unlinked, !lights_other);
    EXPECT_TRUE(lights_other || (view.pdf == 0.0f && is_black(view.radiance)));
  }
}

TEST(LightLinks, ProbabilitiesOfTheTreeSumToOneOverTheLightsThatLightTheReceiver) {
  const auto snapshot = linked_scene();
  const light::LightTable& table = *snapshot->light_table;
  std::mt19937 random(23);
  for (int i = 0; i < 500; ++i) {
    const light::Receiver receiver = random_receiver(random, uint64_t{1} << i % kSets);
    const light::LightTree::Cut cut = table.tree.cut(receiver);
    double sum = 0.0, lit = 0.0;
    for (uint32_t k = 0; k < table.tree.size(); ++k) {
      const uint64_t receivers =
          k < table.tree_lights.size()
              ? table.analytic_lights[table.tree_lights[k]].links.receivers
              : snapshot->instances[table.triangles[k - table.tree_lights.size()].instance].links.receivers;
      const double probability = table.tree.probability(k, receiver, cut);
      sum += probability;
      lit += (receivers & receiver.light_sets) != 0 ? probability : 0.0;
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
    EXPECT_TRUE(cut.irradiance() == 0.0 || std::fabs(lit - 1.0) < 1e-9);
  }
}

TEST(LightLinks, OnlyBlockersBlock) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0), 1.0f, 8, 16));
  for (uint32_t i = 0; i < 3; ++i) {
    scene.links.blocker_set = i;
    scene.instance(1, translation(Vec3(0, 0, 4.0f * float(i))));
  }
  const auto snapshot = scene.commit();
  const Ray ray{Vec3(0, 0, -5), 0.0f, Vec3(0, 0, 1), 20.0f};
  geometry::Hit hit;
  ASSERT_TRUE(snapshot->intersect_blocker(ray, GRADUS_VISIBLE_ALL, 4, &hit));
  EXPECT_NEAR(hit.t, 12.0f, 1e-4f);
  ASSERT_TRUE(snapshot->intersect_blocker(ray, GRADUS_VISIBLE_ALL, 2 | 4, &hit));
  EXPECT_NEAR(hit.t, 8.0f, 1e-4f);
  EXPECT_FALSE(snapshot->intersect_blocker(ray, GRADUS_VISIBLE_ALL, 8, &hit));
  EXPECT_EQ(snapshot->transmittance(ray, 8, 8), Rgb(1.0f));
  EXPECT_EQ(snapshot->transmittance(ray, 8, 1), Rgb(0.0f));
}

}  // namespace
}  // namespace gradus::test::light_links_test
