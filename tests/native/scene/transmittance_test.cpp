// Shadow rays through transparent surfaces, with materials compiled from nodes.
#include <gtest/gtest.h>

#include "light/light_sampling.h"
#include "scene_fixture.h"

namespace gradus::test::transmittance_test {
namespace {

Soup wall(float z) {
  Soup soup;
  soup.triangle({-5, -5, z}, {5, -5, z}, {0, 9, z});
  return soup;
}

const Ray kUp{Vec3(0.0f), 0.0f, Vec3(0, 0, 1), 10.0f};

class Walls : public ::testing::Test {
 protected:
  Walls() {
    scene.material(1, MaterialDesc(GRADUS_OP_TRANSPARENT, Rgb(0.5f, 0.25f, 1.0f)));
    scene.material(2, MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.8f)));
  }
  void add(float z, uint64_t material, uint32_t visibility = GRADUS_VISIBLE_ALL) {
    scene.mesh(++meshes, wall(z));
    scene.instance(meshes, Mat4(1.0f), visibility, material);
  }
  TestScene scene;
  uint64_t meshes = 0;
};

TEST_F(Walls, TransparentOnesMultiply) {
  add(1.0f, 1);
  add(2.0f, 1);
  add(20.0f, 2);  // beyond the segment
  const auto snapshot = scene.commit();
  EXPECT_TRUE(snapshot->features.has_transparent_shadows);
  EXPECT_TRUE(snapshot->occluded(kUp));
  const Rgb through = snapshot->transmittance(kUp, 8);
  EXPECT_NEAR(through.x, 0.25f, 1e-6f);
  EXPECT_NEAR(through.y, 0.0625f, 1e-6f);
  EXPECT_NEAR(through.z, 1.0f, 1e-6f);
  EXPECT_EQ(snapshot->transmittance(kUp, 1), Rgb(0.0f));
}

TEST_F(Walls, OpaqueOnesBlockAndInvisibleOnesDoNot) {
  add(1.0f, 1);
  add(2.0f, 2, GRADUS_VISIBLE_ALL & ~GRADUS_VISIBLE_SHADOW);
  EXPECT_NEAR(scene.commit()->transmittance(kUp, 8).x, 0.5f, 1e-6f);
  add(3.0f, 2);
  EXPECT_EQ(scene.commit()->transmittance(kUp, 8), Rgb(0.0f));
}

TEST_F(Walls, OpaqueSceneNeedsNoProgram) {
  add(1.0f, 2);
  const auto snapshot = scene.commit();
  EXPECT_FALSE(snapshot->features.has_transparent_shadows);
  EXPECT_EQ(snapshot->transmittance(kUp, 8), Rgb(0.0f));
}

TEST(AnalyticLights, AProgramMultipliesTheStrength) {
  TestScene scene;
  scene.material(4, MaterialDesc(GRADUS_OP_EMISSION, Rgb(0.5f, 2.0f, 1.0f), 3.0f));
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(0, 0, 2)), Rgb(1.0f));
  light.material = 4;
  scene.lights({light});
  const auto snapshot = scene.commit();
  light::LightPoint point;
  light::LightEvaluation view;
  light::sample_light_point(*snapshot, {Vec3(0.0f), Vec3(0, 0, 1), false}, 0.5f, Vec2(0.5f), &point, &view);
  EXPECT_NEAR(view.radiance.x, 1.5f / 4, 1e-6f);
  EXPECT_NEAR(view.radiance.y, 6.0f / 4, 1e-6f);
}

}  // namespace
}  // namespace gradus::test::transmittance_test
