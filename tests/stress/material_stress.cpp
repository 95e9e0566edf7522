// Roughness from 0 (mirrors) to 1, indices of refraction near 1 and far from it, glass in glass.
#include <cmath>
#include <iomanip>
#include <sstream>

#include "stress/stress.h"

namespace gradus::stress::material_stress {
namespace {

// Expects pixels between `darkest` and 1. Single scattering loses up to 60 % between facets at roughness 1; nothing may
// be brighter than the light.
void expect_furnace(const Outcome& outcome, double darkest) {
  EXPECT_LE(mean(outcome.noisy), 1.01);
  EXPECT_GE(mean(outcome.noisy), darkest);
  EXPECT_LE(mean(outcome.l2), 1.01);
}

Surface white_metal(float roughness) {
  Surface s = test::glossy(roughness);
  s.glossy = Rgb(1.0f);
  return s;
}

Surface glass(float roughness, float ior) {
  Surface s = test::glass(roughness);
  s.ior = ior;
  return s;
}

std::string named(const char* what, float value) {
  std::ostringstream name;
  name << what << ' ' << std::setprecision(8) << value;
  return name.str();
}

// Blender's roughness; microfacets begin at 0.01732 (alpha 3e-4), class D at 0.316.
std::vector<float> roughnesses() {
  if (!full_run()) return {1e-4f, 0.0174f, 0.1f, 1.0f};
  return {1e-4f, 1e-3f, 1e-2f, 0.0173f, 0.0174f, 0.03f, 0.1f, 0.3f, 0.33f, 0.5f, 1.0f};
}

class Roughness : public ::testing::TestWithParam<float> {};

TEST_P(Roughness, MetalAddsNoLight) {
  PathScene scene;
  build_furnace(&scene, white_metal(GetParam()));
  expect_furnace(render(named("metal, roughness", GetParam()), &scene, Bounds::alone()), 0.6);
}

TEST_P(Roughness, GlassAddsNoLight) {
  PathScene scene;
  build_furnace(&scene, glass(GetParam(), 1.5f));
  expect_furnace(render(named("glass, roughness", GetParam()), &scene, Bounds::alone()), 0.6);
}

// Under a small light, reflections show the shape of the lobe.
TEST_P(Roughness, InTheBox) {
  PathScene scene;
  build_box(&scene);
  scene.ball(Vec3(0.3f, 0.2f, -0.3f), 0.35f, scene.material(white_metal(GetParam())), 12, true);
  scene.ball(Vec3(-0.5f, 0.3f, 0.2f), 0.3f, scene.material(glass(GetParam(), 1.5f)), 12, true);
  render(named("box, roughness", GetParam()), &scene, {});
}

INSTANTIATE_TEST_SUITE_P(FromMirrorToMatte, Roughness, ::testing::ValuesIn(roughnesses()));

// Below |ior - 1| = 1e-3, light passes straight, above it is refracted: indices on both sides, and extreme values.
std::vector<float> indices() {
  if (!full_run()) return {1.0f, 1.0000001f, 0.99899f, 1.00101f, 1.5f};
  return {1.0f,  1.0000001f, 0.9999999f, 1.0001f, 0.99901f, 0.99899f, 1.00099f, 1.00101f,
          1.01f, 1.5f,       0.5f,       3.0f,    100.0f,   1e-3f,    1e6f};
}

class Ior : public ::testing::TestWithParam<float> {};

TEST_P(Ior, SmoothGlassInAFurnaceIsInvisible) {
  PathScene scene;
  build_furnace(&scene, glass(0.0f, GetParam()));
  const Outcome outcome = render(named("smooth glass, ior", GetParam()), &scene, Bounds::alone());
  EXPECT_NEAR(mean(outcome.noisy), 1.0, 0.01);
}

TEST_P(Ior, RoughGlassAddsNoLight) {
  PathScene scene;
  build_furnace(&scene, glass(0.3f, GetParam()));
  expect_furnace(render(named("rough glass, ior", GetParam()), &scene, Bounds::alone()), 0.5);
}

INSTANTIATE_TEST_SUITE_P(NearOneAndFar, Ior, ::testing::ValuesIn(indices()));

// Adds nested balls, with shells of 1 % of the radius; the relative index between two of them is the quotient.
void add_nested(PathScene* scene, int depth, float roughness) {
  for (int i = 0; i < depth; ++i) {
    const float ior = i % 3 == 0 ? 1.33f : i % 3 == 1 ? 1.5f / 1.33f : 1.0f / 1.5f;
    scene->ball(Vec3(0.0f), std::pow(0.9f, float(i)) * (i % 2 == 0 ? 1.0f : 0.99f),
                scene->material(glass(roughness, ior)), 24, true);
  }
}

TEST(NestedDielectrics, AreInvisibleInAFurnace) {
  for (const int depth : {2, 5}) {
    PathScene scene;
    scene.world(Rgb(1.0f));
    add_nested(&scene, depth, 0.0f);
    scene.camera(Vec3(0, 0, 4), Vec3(0.0f), 0.8f);
    GradusSettings settings = small_picture();
    settings.max_bounces = settings.glossy_bounces = settings.transmission_bounces = 256;
    const Outcome outcome =
        render("glass balls in each other: " + std::to_string(depth), &scene, Bounds::alone(), settings);
    EXPECT_NEAR(mean(outcome.noisy), 1.0, 0.02);
  }
}

TEST(NestedDielectrics, InTheBox) {
  PathScene scene;
  build_box(&scene);
  scene.place = test::translation(Vec3(0.1f, 0.1f, 0.0f)) * test::scaling(Vec3(0.5f));
  add_nested(&scene, 4, 0.1f);
  render("glass balls in each other, in the box", &scene, {});
}

}  // namespace
}  // namespace gradus::stress::material_stress
