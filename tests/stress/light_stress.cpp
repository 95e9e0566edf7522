// E4 for the integrators: lights without extent, without power, and with power near the range of floats.
#include <cmath>

#include "stress/stress.h"

namespace gradus::stress::light_stress {
namespace {

using test::make_light;
using test::translation;

struct LightCase {
  const char* name;
  GradusLight light;
};

GradusLight make_test_light(GradusLightType type, float strength) {
  Mat4 down = translation(Vec3(0.2f, 0.6f, 0.2f));  // the light emits along its -z axis
  down[1] = Vec4(0, 0, -1, 0);
  down[2] = Vec4(0, 1, 0, 0);
  GradusLight light = make_light(type, down, Rgb(strength));
  light.size[0] = light.size[1] = 0.3f;
  light.angle = 0.01f;
  light.radius = 0.05f;
  return light;
}

std::vector<LightCase> without_extent() {
  std::vector<LightCase> cases;
  for (const float size : {0.0f, 1e-30f, 1e-6f}) {
    for (const GradusLightType type :
         {GRADUS_LIGHT_POINT, GRADUS_LIGHT_SPOT, GRADUS_LIGHT_SUN, GRADUS_LIGHT_RECTANGLE, GRADUS_LIGHT_ELLIPSE}) {
      GradusLight light = make_test_light(type, 1.0f);
      light.radius = light.angle = light.size[0] = light.size[1] = size;
      cases.push_back({"light without extent", light});
    }
  }
  for (const float cone : {0.0f, 1e-6f, kPi}) {
    GradusLight light = make_test_light(GRADUS_LIGHT_SPOT, 1.0f);
    light.cone = cone;
    cases.push_back({"spot", light});
  }
  for (const float spread : {0.0f, 1e-6f}) {
    GradusLight light = make_test_light(GRADUS_LIGHT_RECTANGLE, 1.0f);
    light.spread = spread;
    cases.push_back({"area without spread", light});
  }
  return cases;
}

std::string name_of(const LightCase& c) {
  return std::string(c.name) + ": type " + std::to_string(c.light.type) + ", size " + text_of(c.light.size[0]) +
         ", cone " + text_of(c.light.cone) + ", spread " + text_of(c.light.spread);
}

TEST(AnalyticLights, WithoutExtent) {
  for (const LightCase& c : without_extent()) {
    PathScene scene;
    build_box(&scene);
    scene.light(c.light);
    render(name_of(c), &scene, {});
  }
}

// 1e38 W are 8e36 W/sr: at a distance of 0.1 m 8e38 W/m², beyond the range of floats. Samples that overflow, or that
// would make a sum overflow, are dropped; the rest of the picture remains. One pixel in 40 sees the area lights
// directly; its samples are dropped with four gradients and some passes.
TEST(AnalyticLights, Of1e38Watts) {
  const GradusSettings settings = small_picture();
  const uint64_t all = uint64_t(settings.width) * settings.height * settings.samples;
  for (const GradusLightType type :
       {GRADUS_LIGHT_POINT, GRADUS_LIGHT_SPOT, GRADUS_LIGHT_SUN, GRADUS_LIGHT_RECTANGLE, GRADUS_LIGHT_ELLIPSE}) {
    PathScene scene;
    build_box(&scene);
    scene.light(make_test_light(type, 1e38f));
    render("light of 1e38, type " + std::to_string(type), &scene, Bounds().dropping(all / 4).without_double());
  }
}

TEST(AnalyticLights, DarkAndNegative) {
  for (const float strength : {0.0f, 1e-38f, 1e-45f, -1.0f}) {
    PathScene scene;
    build_box(&scene);
    scene.light(make_test_light(GRADUS_LIGHT_POINT, strength));
    scene.light(make_test_light(GRADUS_LIGHT_RECTANGLE, strength));
    render("lights of " + text_of(strength), &scene, {});
  }
}

// The light faces away from the box, behind its back wall.
TEST(AnalyticLights, AHugeOneThatFacesAwayAddsNothing) {
  PathScene scene;
  build_box(&scene);
  const Outcome alone = render("box without it", &scene, {});
  scene.light(make_light(GRADUS_LIGHT_RECTANGLE, translation(Vec3(0, 0, -50)), Rgb(1e30f)));
  const Outcome outcome = render("light of 1e30 that faces away", &scene, {});
  EXPECT_NEAR(mean(outcome.noisy) / mean(alone.noisy), 1.0, 0.05);
}

TEST(AnalyticLights, EmissiveTrianglesOfAnySize) {
  for (const float size : {1e-12f, 1e-6f, 1e4f}) {
    PathScene scene;
    build_box(&scene);
    Surface light;
    light.emission = Rgb(1.0f);
    scene.quad(Vec3(-size, 0.5f, -size), Vec3(2 * size, 0, 0), Vec3(0, 0, 2 * size), scene.material(light));
    render("emissive triangles of " + text_of(size), &scene, {});
  }
}

}  // namespace
}  // namespace gradus::stress::light_stress
