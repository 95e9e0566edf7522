// Irradiance at a point from each kind of light, by light sampling, against closed forms.
#include <functional>

#include <gtest/gtest.h>

#include "light/light_sampling.h"
#include "scene/scene_fixture.h"

namespace gradus::test::light_units_test {
namespace {

const Mat4 kDown(1.0f);  // emits along -Z

// Returns the irradiance at the origin, for a normal along +Z: the mean of radiance·cos/pdf (Dirac: ·cos/choice).
double irradiance(const scene::Snapshot& snapshot, const light::Receiver& receiver, int count = 20000) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 0.9999999f);
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const float choice = uniform(random), x = uniform(random);
    light::LightPoint point;
    light::LightEvaluation sampled_view;
    light::sample_light_point(snapshot, receiver, choice, Vec2(x, uniform(random)), &point, &sampled_view);
    if (point.kind == light::LightKind::None) continue;
    const light::LightEvaluation view = light::evaluate_light(snapshot, point, receiver);
    const float cosine = glm::dot(receiver.normal, view.direction);
    if (view.pdf > 0.0f && cosine > 0.0f) sum += view.radiance.x * cosine / view.pdf;
  }
  return sum / count;
}

double irradiance_of(const GradusLight& light, const light::Receiver& receiver = {Vec3(0.0f), Vec3(0, 0, 1), false}) {
  TestScene scene;
  scene.lights({light});
  return irradiance(*scene.commit(), receiver);
}

TEST(LightUnits, Point) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(1, 0, 2)), Rgb(3.0f));
  const double d2 = 5.0, cosine = 2.0 / std::sqrt(5.0);
  EXPECT_NEAR(irradiance_of(light), 3.0 * cosine / d2, 1e-5);
}

TEST(LightUnits, SphereKeepsItsIntensity) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(1, 0, 2)), Rgb(3.0f));
  light.radius = 0.7f;
  // A sphere that lies completely above the horizon gives the irradiance of a point light at its centre.
  EXPECT_NEAR(irradiance_of(light), 3.0 * 2.0 / std::pow(5.0, 1.5), 2e-3);
}

TEST(LightUnits, FacingDisk) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(0, 0, 2)), Rgb(3.0f));
  light.radius = 0.5f;
  light.flags = GRADUS_LIGHT_DISK_FACING;
  // Disk overhead: pi L r²/(r² + d²), L = I/(pi r²).
  EXPECT_NEAR(irradiance_of(light), 3.0 / (0.25 + 4.0), 1e-3);
}

TEST(LightUnits, TinyRadiusIsAPoint) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(1, 0, 2)), Rgb(3.0f));
  for (const float radius : {1e-30f, 1e-12f, 1e-9f, 1e-4f}) {
    light.radius = radius;
    EXPECT_NEAR(irradiance_of(light), 3.0 * 2.0 / std::pow(5.0, 1.5), 1e-4) << radius;
  }
}

TEST(LightUnits, InvalidAndDarkLightsGiveNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (uint32_t type = 0; type < 5; ++type) {
    GradusLight light = make_light(GradusLightType(type), translation(Vec3(0, 0, 2)), Rgb(0.0f));
    EXPECT_EQ(irradiance_of(light), 0.0);
    light.strength[1] = nan;
    EXPECT_EQ(irradiance_of(light), 0.0);
    light = make_light(GradusLightType(type), translation(Vec3(nan, 0, 2)), Rgb(1.0f));
    EXPECT_EQ(irradiance_of(light), 0.0);
    light = make_light(GradusLightType(type), scaling(Vec3(0.0f)), Rgb(1.0f));
    EXPECT_TRUE(std::isfinite(irradiance_of(light)));
  }
}

// E4: huge and negative energies.
TEST(LightUnits, NegativeLightsSubtractAndHugeOnesStayPositive) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(0, 0, 2)), Rgb(-3.0f));
  EXPECT_NEAR(irradiance_of(light), -0.75, 1e-5);
  light = make_light(GRADUS_LIGHT_POINT, translation(Vec3(0, 0, 2)), Rgb(1e38f));
  EXPECT_GT(irradiance_of(light), 1e37);
}

TEST(LightUnits, SpotBlendAndExtraCosine) {
  GradusLight light = make_light(GRADUS_LIGHT_SPOT, translation(Vec3(0, 0, 2)) * kDown, Rgb(3.0f));
  light.cone = 1.0f;
  light.blend = 0.5f;
  EXPECT_NEAR(irradiance_of(light), 3.0 / 4.0, 1e-5);
  const double x = 0.85;  // near the edge: the angle is about 0.4 of 0.5
  const double distance = std::sqrt(4.0 + x * x), cosine = 2.0 / distance, edge = std::cos(0.5);
  const double t = std::min(1.0, (cosine - edge) / ((1.0 - edge) * 0.5)), smooth = t * t * (3 - 2 * t);
  const light::Receiver receiver{Vec3(float(x), 0, 0), Vec3(0, 0, 1), false};
  EXPECT_NEAR(irradiance_of(light, receiver), 3.0 * cosine / (distance * distance) * smooth, 1e-4);
  EXPECT_LT(smooth, 0.99);
  light.flags = GRADUS_LIGHT_SPOT_COSINE;
  EXPECT_NEAR(irradiance_of(light, receiver), 3.0 * cosine * cosine / (distance * distance) * smooth, 1e-4);
  EXPECT_EQ(irradiance_of(light, {Vec3(3, 0, 0), Vec3(0, 0, 1), false}), 0.0);
}

TEST(LightUnits, SunWithAndWithoutAngle) {
  GradusLight light = make_light(GRADUS_LIGHT_SUN, kDown, Rgb(2.0f));
  EXPECT_NEAR(irradiance_of(light), 2.0, 1e-5);
  light.angle = 0.5f;
  EXPECT_NEAR(irradiance_of(light), 2.0, 2e-3);
  light.sun_radiance_per_irradiance = 3.0f;
  EXPECT_NEAR(irradiance_of(light), 2.0 * 3.0 * kPi * std::pow(std::sin(0.25), 2), 2e-3);
}

// Returns the irradiance of a Lambertian rectangle at height h above its centre (form factor of a parallel rectangle).
double rectangle_irradiance(double radiance, double width, double height, double h) {
  const double a = 0.5 * width / h, b = 0.5 * height / h;
  const double corner = a / std::sqrt(1 + a * a) * std::atan(b / std::sqrt(1 + a * a)) +
                        b / std::sqrt(1 + b * b) * std::atan(a / std::sqrt(1 + b * b));
  return radiance * 2.0 * corner;  // four corners of (1/2)·(…)
}

TEST(LightUnits, RectangleNearAndFar) {
  for (const float h : {0.3f, 2.0f, 200.0f}) {
    GradusLight light = make_light(GRADUS_LIGHT_RECTANGLE, translation(Vec3(0, 0, h)), Rgb(5.0f));
    light.size[0] = 2.0f;
    light.size[1] = 1.0f;
    const double expected = rectangle_irradiance(5.0, 2.0, 1.0, h);
    EXPECT_NEAR(irradiance_of(light), expected, 0.006 * expected) << h;
  }
}

TEST(LightUnits, EllipseAsADisk) {
  GradusLight light = make_light(GRADUS_LIGHT_ELLIPSE, translation(Vec3(0, 0, 2)), Rgb(5.0f));
  light.size[0] = light.size[1] = 1.0f;
  EXPECT_NEAR(irradiance_of(light), 5.0 * kPi * 0.25 / (0.25 + 4.0), 5e-3);
}

TEST(LightUnits, AreaIsDarkFromBehind) {
  GradusLight light = make_light(GRADUS_LIGHT_RECTANGLE, translation(Vec3(0, 0, -2)), Rgb(5.0f));
  EXPECT_EQ(irradiance_of(light, {Vec3(0.0f), Vec3(0, 0, -1), false}), 0.0);
}

// The flux through a hemisphere around a small light does not depend on the spread.
TEST(LightUnits, SpreadKeepsTheFlux) {
  for (const float spread : {0.5f, 2.0f, kPi}) {
    GradusLight light = make_light(GRADUS_LIGHT_RECTANGLE, kDown, Rgb(1.0f));
    light.size[0] = light.size[1] = 0.02f;
    light.spread = spread;
    TestScene scene;
    scene.lights({light});
    const auto snapshot = scene.commit();
    double flux = 0.0;
    constexpr int kRings = 400;
    for (int i = 0; i < kRings; ++i) {
      const double theta = (i + 0.5) * kPi / 2 / kRings;
      const Vec3 p = 10.0f * Vec3(float(std::sin(theta)), 0, -float(std::cos(theta)));
      flux += irradiance(*snapshot, {p, glm::normalize(-p), false}, 4) * std::sin(theta) * 100.0 * 2 * kPi *
              (kPi / 2 / kRings);
    }
    EXPECT_NEAR(flux, kPi * 0.0004, 0.01 * kPi * 0.0004) << spread;
  }
}

// Regression: with a spread of 1° nearly all samples fell where the receiver gets no light, and 64 of them lost it.
TEST(LightUnits, NarrowSpreadHasLittleNoise) {
  for (const GradusLightType type : {GRADUS_LIGHT_RECTANGLE, GRADUS_LIGHT_ELLIPSE}) {
    for (const float degrees : {0.1f, 0.3f, 1.0f, 10.0f, 40.0f}) {
      SCOPED_TRACE(degrees);
      GradusLight light = make_light(type, translation(Vec3(0, 0, 3)), Rgb(3.0f));
      light.size[0] = 4.0f;
      light.size[1] = 3.0f;
      light.spread = degrees * kPi / 180.0f;
      TestScene scene;
      scene.lights({light});
      const auto snapshot = scene.commit();
      // The circle that a receiver sees lies within the light, so that its irradiance is that of a light without end.
      const Vec3 places[3] = {Vec3(0.0f), Vec3(0.7f, -0.2f, 0.0f), Vec3(0.2f, 0.3f, 2.9f)};
      for (const Vec3& place : places)
        EXPECT_NEAR(irradiance(*snapshot, {place, Vec3(0, 0, 1), false}, 64) / (3.0 * kPi), 1.0, 0.02);
      // At the edge of a rectangle half of that circle is light; beyond it nothing is.
      if (type == GRADUS_LIGHT_RECTANGLE) {
        EXPECT_NEAR(irradiance(*snapshot, {Vec3(2, 0, 0), Vec3(0, 0, 1), false}, 20000) / (3.0 * kPi), 0.5, 0.02);
      }
      // At a corner, with a quarter of the circle on the light, the rectangle that both have in common is sampled.
      if (type == GRADUS_LIGHT_RECTANGLE) {
        EXPECT_NEAR(irradiance(*snapshot, {Vec3(2, 1.5f, 0), Vec3(0, 0, 1), false}, 20000) / (3.0 * kPi), 0.25, 0.01);
      }
      EXPECT_EQ(irradiance(*snapshot, {Vec3(2.1f + 3.0f * std::tan(0.5f * light.spread), 0, 0), Vec3(0, 0, 1), false}),
                0.0);
    }
  }
}

TEST(LightUnits, EmissiveQuad) {
  Soup soup;
  soup.triangle({-1, -0.5f, 2}, {1, -0.5f, 2}, {1, 0.5f, 2});
  soup.triangle({-1, -0.5f, 2}, {1, 0.5f, 2}, {-1, 0.5f, 2});
  TestScene scene;
  scene.mesh(1, soup);
  scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), 5.0f));
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 5);
  const double expected = rectangle_irradiance(5.0, 2.0, 1.0, 2.0);
  EXPECT_NEAR(irradiance(*scene.commit(), {Vec3(0.0f), Vec3(0, 0, 1), false}, 200000), expected, 0.005 * expected);
}

TEST(LightUnits, ConstantWorld) {
  TestScene scene;
  scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), 2.0f));
  scene.world(5);
  EXPECT_NEAR(irradiance(*scene.commit(), {Vec3(0.0f), Vec3(0, 0, 1), false}, 200000), 2.0 * kPi, 0.03);
}

}  // namespace
}  // namespace gradus::test::light_units_test
