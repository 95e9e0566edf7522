// Sky Texture: values of Cycles, the suns that are found in a world, and extreme settings.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/cone.h"
#include "shading/program_builder.h"
#include "shading/sky/sky.h"

namespace gradus::test::sky_test {
namespace {

constexpr uint32_t kModes = GRADUS_SKY_MULTIPLE_SCATTERING + 1;

float radians(float degrees) { return degrees * kPi / 180.0f; }

// Returns settings with the sun at 30° of elevation, 25° from +y towards +x.
std::vector<float> settings(uint32_t mode) {
  const float e = radians(30), r = radians(25);
  if (mode <= GRADUS_SKY_HOSEK_WILKIE)
    return {std::cos(e) * std::sin(r), std::cos(e) * std::cos(r), std::sin(e), 3.5f, 0.4f};
  return {e, r, -1.0f, 1.0f, 500.0f, 1.2f, 0.8f, 1.5f};
}

// Values of Blender 5.0 (NISHITA: 4.5), without noise.
struct Known {
  Vec3 direction;
  Rgb radiance[kModes];
};
const Known kKnown[] = {
    {Vec3(0.6f, 0.0f, 0.8f),
     {{0.31365f, 0.45589f, 0.78222f},
      {0.031083f, 0.049851f, 0.085834f},
      {1.0795f, 1.7203f, 2.9764f},
      {1.0825f, 1.7245f, 2.982f},
      {1.2508f, 2.5874f, 5.2668f}}},
    {Vec3(0.36f, 0.48f, 0.8f),
     {{0.6562f, 0.79162f, 1.2176f},
      {0.067226f, 0.085871f, 0.1195f},
      {2.2263f, 2.9296f, 4.4259f},
      {2.2509f, 2.9534f, 4.4497f},
      {1.8884f, 3.5335f, 6.7063f}}},
    {Vec3(-0.8f, 0.59f, 0.1086f),
     {{0.48476f, 0.45509f, 0.47229f},
      {0.11281f, 0.15304f, 0.19211f},
      {3.8777f, 5.0603f, 5.2743f},
      {3.8862f, 5.066f, 5.2711f},
      {6.0511f, 9.3582f, 12.224f}}},
    {Vec3(0.0f, 0.995f, -0.0999f),
     {{0.96811f, 0.70497f, 0.61145f},
      {0.24576f, 0.25482f, 0.20211f},
      {5.6579f, 4.0863f, 2.1411f},
      {5.4853f, 3.9609f, 2.075f},
      {1.7983f, 2.442f, 3.6072f}}},
};

TEST(A9_Sky, HasTheValuesOfCycles) {
  for (uint32_t mode = 0; mode < kModes; ++mode) {
    SCOPED_TRACE(mode);
    const std::vector<float> prepared = shading::prepare_sky(mode, settings(mode).data());
    for (const Known& known : kKnown) {
      const Rgb found = shading::sky(mode, prepared.data(), known.direction);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], known.radiance[mode][c], 2e-3f * known.radiance[mode][c]) << c;
    }
  }
}

// Returns the irradiance of the disc alone on a plane that faces it.
Rgb sun_irradiance(uint32_t mode, std::vector<float> given) {
  const std::vector<float> with = shading::prepare_sky(mode, given.data());
  given[2] = -1.0f;
  const std::vector<float> without = shading::prepare_sky(mode, given.data());
  const shading::SunDisc disc = *shading::sun_disc(mode, with.data());
  const float h = std::sin(0.505f * disc.half_angle);
  const Cone cone{disc.direction, 2.0f * h * h};
  constexpr int kSide = 100;
  glm::dvec3 sum(0.0);
  for (int k = 0; k < kSide * kSide; ++k) {
    const Vec3 d = cone.sample((Vec2(float(k % kSide), float(k / kSide)) + 0.5f) / float(kSide));
    sum += glm::dvec3(shading::sky(mode, with.data(), d) - shading::sky(mode, without.data(), d));
  }
  return Rgb(sum * double(cone.solid_angle()) / double(kSide * kSide));
}

TEST(A9_Sky, TheSunHasTheSameIrradianceAtAnySize) {
  for (uint32_t mode = GRADUS_SKY_NISHITA; mode < kModes; ++mode) {
    SCOPED_TRACE(mode);
    std::vector<float> given = settings(mode);
    given[2] = 0.0095f;
    const Rgb usual = sun_irradiance(mode, given);
    EXPECT_GT(usual.z, 30.0f);
    for (const float size : {0.0f, 0.1f}) {
      given[2] = size;
      const Rgb found = sun_irradiance(mode, given);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / usual[c], 1.0f, 0.015f) << size;
    }
  }
}

TEST(A9_Sky, BeyondTheZenithTheSunSetsOnTheOtherSide) {
  std::vector<float> over = settings(GRADUS_SKY_NISHITA), same = over;
  over[0] = radians(150);
  over[1] = radians(25 + 180 - 360);
  const std::vector<float> a = shading::prepare_sky(GRADUS_SKY_NISHITA, over.data()),
                           b = shading::prepare_sky(GRADUS_SKY_NISHITA, same.data());
  for (const Known& known : kKnown) {
    const Rgb x = shading::sky(GRADUS_SKY_NISHITA, a.data(), known.direction),
              y = shading::sky(GRADUS_SKY_NISHITA, b.data(), known.direction);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(x[c], y[c], 1e-3f * y[c]);
  }
}

void expect_finite(uint32_t mode, const std::vector<float>& given) {
  const std::vector<float> prepared = shading::prepare_sky(mode, given.data());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3> directions = {Vec3(0.0f),    Vec3(0, 0, 1), Vec3(0, 0, -1),
                                  Vec3(1, 0, 0), Vec3(1e30f),   Vec3(kNan, 0, 1)};
  if (const auto disc = shading::sun_disc(mode, prepared.data())) directions.push_back(disc->direction);
  for (int i = 0; i < 64; ++i) {
    const float z = 2.0f * (float(i) + 0.5f) / 64.0f - 1.0f, s = std::sqrt(1.0f - z * z);
    directions.emplace_back(s * std::cos(2.4f * float(i)), s * std::sin(2.4f * float(i)), z);
  }
  for (const Vec3& d : directions) {
    const Rgb found = shading::sky(mode, prepared.data(), d);
    EXPECT_TRUE(is_finite(found)) << d.x << ' ' << d.y << ' ' << d.z;
    EXPECT_TRUE(found.x >= 0.0f && found.y >= 0.0f && found.z >= 0.0f);
  }
}

TEST(Sky, StaysFiniteForAnySettings) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> domes[] = {
      {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 1.0f, 1.0f, 1.0f},             // a sun of size 0 on the horizon
      {-0.001f, 0.0f, 0.0095f, 1.0f, 1e9f, 0.0f, 0.0f, 0.0f},       // in space, without air
      {-1.5f, 0.0f, 0.0095f, 1.0f, -5.0f, 1000.0f, 1000.0f, 1e3f},  // midnight in the thickest smoke, below ground
      {1.5707963f, 9.0f, 3.2f, 1e30f, 100.0f, 1e30f, 1e-30f, -1.0f},
      {kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan},
      {kInfinity, -kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity}};
  const std::vector<float> analytic[] = {{0, 0, 0, 0, -1},         {0, 0, -1, 1, 0},
                                         {1, 0, 0, 10, 1},         {0, 1e-9f, 0, 1e9f, 5},
                                         {kNan, 0, 1, kNan, kNan}, {0, 0, kInfinity, kInfinity, -kInfinity}};
  for (uint32_t mode = 0; mode < kModes; ++mode) {
    SCOPED_TRACE(mode);
    for (int i = 0; i < 6; ++i) {
      SCOPED_TRACE(i);
      expect_finite(mode, mode <= GRADUS_SKY_HOSEK_WILKIE ? analytic[i] : domes[i]);
    }
  }
}

// Returns a world whose sky uses the direction transformed by `mapping`.
std::shared_ptr<const shading::MaterialData> world(const Vec3& rotation, const Vec3& scale) {
  ProgramBuilder b;
  const int place = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
  const int turned =
      b.add(GRADUS_OP_MAPPING, {In::from(place), In(Vec3(0.0f)), In(rotation), In(scale)}, GRADUS_MAPPING_POINT);
  const int spun = b.add(GRADUS_OP_VECTOR_ROTATE,
                         {In::from(turned), In(Vec3(0.0f)), In(Vec3(0, 0, 1)), In(0.4f), In(Vec3(0.0f))}, 0);
  std::vector<float> given = settings(GRADUS_SKY_NISHITA);
  given[2] = 0.01f;
  const int sky = b.add(GRADUS_OP_SKY, {In::from(spun)}, GRADUS_SKY_NISHITA, given);
  return b.compile(b.add(GRADUS_OP_EMISSION, {In::from(sky), In(1.0f)}));
}

TEST(Sky, SunIsFoundThroughRotations) {
  const auto material = world(Vec3(0.3f, -0.2f, 1.1f), Vec3(1.0f));
  ASSERT_EQ(material->suns.size(), 1u);
  EXPECT_EQ(material->smallest_hidden_sun, 0.0f);
  shading::ShadeContext context;
  context.is_background = true;
  context.position = material->suns[0].direction;
  EXPECT_GT(run(material->emission, context).emission.x, 1e5f);
  context.position = glm::normalize(material->suns[0].direction + Vec3(0, 0, 0.02f));
  EXPECT_LT(run(material->emission, context).emission.x, 100.0f);
}

TEST(Sky, SunBehindAnotherMappingIsLeftToTheMap) {
  const auto material = world(Vec3(0.3f, -0.2f, 1.1f), Vec3(1.0f, 1.0f, -0.9f));
  EXPECT_TRUE(material->suns.empty());
  EXPECT_FLOAT_EQ(material->smallest_hidden_sun, 0.005f);
}

TEST(Sky, TooManyAreRefused) {
  ProgramBuilder b;
  std::vector<float> given = settings(GRADUS_SKY_PREETHAM);
  int sum = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
  for (int i = 0; i < 17; ++i) sum = b.add(GRADUS_OP_SKY, {In::from(sum)}, GRADUS_SKY_PREETHAM, given);
  EXPECT_THROW(b.compile(b.add(GRADUS_OP_EMISSION, {In::from(sum), In(1.0f)})), std::exception);
}

}  // namespace
}  // namespace gradus::test::sky_test
