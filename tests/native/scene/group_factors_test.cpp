// The shares of light samples that suns, the world and other emitters get.
#include "scene/group_factors.h"

#include <cmath>
#include <memory>
#include <utility>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <glm/gtc/matrix_transform.hpp>

#include "light/light_table.h"
#include "scene/scene_fixture.h"

namespace gradus::test::group_factors_test {
namespace {

constexpr uint64_t kFloor = 1, kRoof = 2, kGrey = 3, kSky = 4;

Soup square(float size, float height) {
  Soup soup;
  const Vec3 a(-size, -size, height), b(size, -size, height), c(size, size, height), d(-size, size, height);
  soup.triangle(a, b, c);
  soup.triangle(a, c, d);
  return soup;
}

// A grey floor that a camera looks down on, under a grey sky.
class Outdoors {
 public:
  explicit Outdoors(std::shared_ptr<scene::Device> device = test_device()) : scene(std::move(device)) {
    scene.mesh(kFloor, square(20.0f, 0.0f));
    scene.material(kGrey, MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.5f)));
    scene.material(kSky, MaterialDesc(GRADUS_OP_EMISSION, Rgb(0.5f)));
    scene.instance(kFloor, Mat4(1.0f), GRADUS_VISIBLE_ALL, kGrey);
    scene.world(kSky);
  }
  void add_camera() {
    GradusCamera camera{};
    camera.struct_size = sizeof(camera);
    const float window[4] = {-0.5f, 0.5f, -0.3f, 0.3f};
    set_static(&camera, window, translation(Vec3(0, 0, 3.0f)));
    scene.scene.set_camera(camera);
  }
  // Adds a roof without walls, 5 m above the floor.
  void add_roof(float size) {
    scene.mesh(kRoof, square(size, 5.0f));
    scene.instance(kRoof, Mat4(1.0f), GRADUS_VISIBLE_ALL, kGrey);
  }
  void add_sun() {
    const Mat4 tilted = glm::rotate(Mat4(1.0f), 0.5f, Vec3(1, 0, 0));
    sun = make_light(GRADUS_LIGHT_SUN, tilted, Rgb(3.0f));
    scene.lights({sun});
  }
  light::GroupFactors factors() { return scene.commit()->light_table->factors; }

  TestScene scene;
  GradusLight sun{};
};

TEST(GroupFactors, AnOpenUniformWorldIsLeftToBsdfSampling) {
  Outdoors scene;
  scene.add_camera();
  EXPECT_EQ(scene.factors().world, 0.0);
  scene.add_sun();
  EXPECT_EQ(scene.factors().world, 0.0);
}

TEST(GroupFactors, WithoutACameraNothingIsMeasured) {
  Outdoors scene;
  scene.add_sun();
  EXPECT_EQ(scene.factors().world, 1.0);
  EXPECT_EQ(scene.factors().suns, 1.0);
}

TEST(GroupFactors, AWorldBesideARoofIsSampledMoreThanAHiddenSun) {
  Outdoors scene;
  scene.add_camera();
  scene.add_sun();
  scene.add_roof(15.0f);
  EXPECT_GT(scene.factors().world, 1.0);
}

TEST(GroupFactors, TheSameSceneHasTheSameFactors) {
  for (int i = 0; i < 3; ++i) {
    Outdoors scene;
    scene.add_camera();
    scene.add_sun();
    scene.add_roof(4.0f);
    static const light::GroupFactors first = scene.factors();
    const light::GroupFactors again = scene.factors();
    EXPECT_EQ(again.suns, first.suns);
    EXPECT_EQ(again.world, first.world);
  }
}

TEST(GroupFactors, TheyDoNotDependOnTheNumberOfThreads) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  light::GroupFactors first;
  for (const uint32_t threads : {1u, 2u, 5u}) {
    GradusDeviceSettings settings{};
    settings.struct_size = sizeof(settings);
    settings.threads = threads;
    Outdoors scene(std::make_shared<scene::Device>(settings));
    scene.add_camera();
    scene.add_sun();
    scene.add_roof(15.0f);
    const light::GroupFactors factors = scene.factors();
    if (threads == 1) first = factors;
    EXPECT_NE(factors.world, 1.0);
    EXPECT_EQ(factors.suns, first.suns) << threads;
    EXPECT_EQ(factors.world, first.world) << threads;
  }
}

TEST(GroupChoice, GroupsHaveEighthsAndAtLeastOne) {
  const light::GroupChoice two = light::choose_group({0.0, 0.4, 0.6}, {});
  EXPECT_EQ(two.tree, 0.0);
  EXPECT_EQ(two.suns, 0.375);
  EXPECT_EQ(two.world, 0.625);
  const light::GroupChoice faint = light::choose_group({1e-6, 3.0, 1.0}, {});
  EXPECT_EQ(faint.tree, 0.125);
  EXPECT_EQ(faint.suns, 0.625);
  EXPECT_EQ(faint.world, 0.25);
}

TEST(GroupChoice, FactorsShiftSharesAndLeaveGroupsOut) {
  const light::GroupChoice shifted = light::choose_group({0.0, 1.0, 1.0}, {1.0, 1.0, 0.25});
  EXPECT_EQ(shifted.suns, 0.75);
  EXPECT_EQ(shifted.world, 0.25);
  const light::GroupChoice without = light::choose_group({1.0, 0.0, 5.0}, {1.0, 1.0, 0.0});
  EXPECT_EQ(without.tree, 1.0);
  EXPECT_EQ(without.world, 0.0);
  const light::GroupChoice nothing = light::choose_group({0.0, 0.0, 5.0}, {1.0, 1.0, 0.0});
  EXPECT_EQ(nothing.tree + nothing.suns + nothing.world, 0.0);
}

TEST(GroupChoice, ValuesThatAreNotFiniteChooseNothing) {
  const light::GroupChoice infinite = light::choose_group({INFINITY, 1.0, 1.0}, {});
  EXPECT_EQ(infinite.tree + infinite.suns + infinite.world, 0.0);
  const light::GroupChoice nan = light::choose_group({1.0, NAN, 1.0}, {});
  EXPECT_EQ(nan.tree + nan.suns + nan.world, 0.0);
}

}  // namespace
}  // namespace gradus::test::group_factors_test
