// Operations against their definitions.
#include <cmath>

#include <gtest/gtest.h>

#include "shading/ies_table.h"
#include "shading/lattice_hash.h"
#include "shading/perlin.h"
#include "shading/program_builder.h"
#include "shading/rotation.h"

namespace gradus::test::ops_test {
namespace {

void expect_near(const Rgb& a, const Rgb& b, float tolerance = 1e-5f) {
  for (int i = 0; i < 3; i++) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

float math_of(uint32_t mode, float a, float b = 0.0f, float c = 0.0f) {
  return evaluate(GRADUS_OP_MATH, {a, b, c}, mode).x;
}

TEST(NodeMath, ClosedForms) {
  const float a = 1.7f, b = -0.6f, c = 0.3f;
  const struct {
    uint32_t mode;
    float expected;
  } cases[] = {
      {GRADUS_MATH_ADD, a + b},
      {GRADUS_MATH_SUBTRACT, a - b},
      {GRADUS_MATH_MULTIPLY, a * b},
      {GRADUS_MATH_DIVIDE, a / b},
      {GRADUS_MATH_MULTIPLY_ADD, a * b + c},
      {GRADUS_MATH_POWER, std::pow(a, b)},
      {GRADUS_MATH_SQRT, std::sqrt(a)},
      {GRADUS_MATH_INVERSE_SQRT, 1.0f / std::sqrt(a)},
      {GRADUS_MATH_EXPONENT, std::exp(a)},
      {GRADUS_MATH_MINIMUM, b},
      {GRADUS_MATH_MAXIMUM, a},
      {GRADUS_MATH_LESS_THAN, 0.0f},
      {GRADUS_MATH_GREATER_THAN, 1.0f},
      {GRADUS_MATH_SIGN, 1.0f},
      {GRADUS_MATH_ROUND, 2.0f},
      {GRADUS_MATH_FLOOR, 1.0f},
      {GRADUS_MATH_CEIL, 2.0f},
      {GRADUS_MATH_TRUNC, 1.0f},
      {GRADUS_MATH_FRACT, 0.7f},
      {GRADUS_MATH_MODULO, std::fmod(a, b)},
      {GRADUS_MATH_FLOORED_MODULO, a - std::floor(a / b) * b},
      {GRADUS_MATH_SNAP, std::floor(a / b) * b},
      {GRADUS_MATH_ARCTAN2, std::atan2(a, b)},
      {GRADUS_MATH_SINE, std::sin(a)},
      {GRADUS_MATH_TANH, std::tanh(a)},
      {GRADUS_MATH_RADIANS, a * kPi / 180.0f},
  };
  for (const auto& item : cases) EXPECT_NEAR(math_of(item.mode, a, b, c), item.expected, 1e-5f) << "mode " << item.mode;
}

TEST(NodeMath, DefinedWhereTheFunctionIsNot) {
  EXPECT_EQ(math_of(GRADUS_MATH_DIVIDE, 1.0f, 0.0f), 0.0f);
  EXPECT_EQ(math_of(GRADUS_MATH_POWER, -2.0f, 0.5f), 0.0f);
  EXPECT_EQ(math_of(GRADUS_MATH_POWER, -2.0f, 2.0f), 4.0f);
  EXPECT_EQ(math_of(GRADUS_MATH_LOGARITHM, -1.0f, 2.0f), 0.0f);
  EXPECT_EQ(math_of(GRADUS_MATH_SQRT, -1.0f), 0.0f);
  EXPECT_EQ(math_of(GRADUS_MATH_INVERSE_SQRT, 0.0f), 0.0f);
  EXPECT_EQ(math_of(GRADUS_MATH_MODULO, 1.0f, 0.0f), 0.0f);
  EXPECT_NEAR(math_of(GRADUS_MATH_ARCSINE, 3.0f), kPi / 2.0f, 1e-6f);
  EXPECT_NEAR(math_of(GRADUS_MATH_WRAP, 5.25f, 3.0f, 1.0f), 1.25f, 1e-6f);
  EXPECT_NEAR(math_of(GRADUS_MATH_PINGPONG, 1.3f, 1.0f), 0.7f, 1e-6f);
  EXPECT_EQ(math_of(GRADUS_MATH_ADD | 64, 3.0f, 4.0f), 1.0f);
}

TEST(NodeVectorMath, ClosedForms) {
  const Vec3 a(1, 2, 3), b(-2, 0.5f, 4);
  const auto of = [&](uint32_t mode, uint32_t output) {
    return evaluate(GRADUS_OP_VECTOR_MATH, {a, b, 0.0f, 2.0f}, mode, {}, output);
  };
  expect_near(of(GRADUS_VECTOR_CROSS_PRODUCT, 0), glm::cross(a, b));
  expect_near(of(GRADUS_VECTOR_PROJECT, 0), b * (glm::dot(a, b) / glm::dot(b, b)));
  expect_near(of(GRADUS_VECTOR_REFLECT, 0), glm::reflect(a, glm::normalize(b)));
  expect_near(of(GRADUS_VECTOR_SCALE, 0), a * 2.0f);
  expect_near(of(GRADUS_VECTOR_DOT_PRODUCT, 1), Vec3(glm::dot(a, b)));
  expect_near(of(GRADUS_VECTOR_DISTANCE, 1), Vec3(glm::distance(a, b)));
  expect_near(of(GRADUS_VECTOR_LENGTH, 1), Vec3(glm::length(a)));
  expect_near(evaluate(GRADUS_OP_VECTOR_MATH, {0.0f}, GRADUS_VECTOR_NORMALIZE), Vec3(0.0f));
}

TEST(NodeMapping, PointAndTextureAreInverse) {
  const Vec3 v(0.3f, -1.1f, 2.0f), location(1, 2, 3), rotation(0.4f, 0.5f, 0.6f), scale(2.0f, 0.5f, 1.5f);
  const Vec3 there = evaluate(GRADUS_OP_MAPPING, {v, location, rotation, scale}, GRADUS_MAPPING_POINT);
  expect_near(there, shading::euler_matrix(rotation) * (v * scale) + location);
  expect_near(evaluate(GRADUS_OP_MAPPING, {there, location, rotation, scale}, GRADUS_MAPPING_TEXTURE), v);
}

TEST(NodeMapping, EulerRotatesAboutXThenYThenZ) {
  const Mat3 quarter_x = shading::euler_matrix(Vec3(kPi / 2, 0, 0)),
             quarter_z = shading::euler_matrix(Vec3(0, 0, kPi / 2));
  expect_near(quarter_x * Vec3(0, 1, 0), Vec3(0, 0, 1));
  expect_near(quarter_z * Vec3(1, 0, 0), Vec3(0, 1, 0));
  expect_near(shading::euler_matrix(Vec3(kPi / 2, 0, kPi / 2)) * Vec3(0, 1, 0),
              quarter_z * (quarter_x * Vec3(0, 1, 0)));
}

TEST(NodeMapRange, LinearSteppedAndClamped) {
  const auto of = [](float x, uint32_t mode) {
    return evaluate(GRADUS_OP_MAP_RANGE, {x, 1.0f, 3.0f, 10.0f, 20.0f, 4.0f}, mode).x;
  };
  EXPECT_NEAR(of(1.5f, GRADUS_MAP_RANGE_LINEAR), 12.5f, 1e-5f);
  EXPECT_NEAR(of(4.0f, GRADUS_MAP_RANGE_LINEAR), 25.0f, 1e-5f);
  EXPECT_NEAR(of(4.0f, GRADUS_MAP_RANGE_LINEAR | 8), 20.0f, 1e-5f);
  EXPECT_NEAR(of(2.0f, GRADUS_MAP_RANGE_SMOOTHSTEP), 15.0f, 1e-5f);
  EXPECT_NEAR(of(2.0f, GRADUS_MAP_RANGE_STEPPED), 15.0f, 1e-5f);
}

// Regression: for an empty range, the smooth forms gave a step, or 0 in spite of the clamp. The values are those of
// Cycles.
TEST(NodeMapRange, EmptyRangesAreThoseOfCycles) {
  for (const uint32_t mode : {GRADUS_MAP_RANGE_LINEAR, GRADUS_MAP_RANGE_STEPPED, GRADUS_MAP_RANGE_SMOOTHSTEP,
                              GRADUS_MAP_RANGE_SMOOTHERSTEP}) {
    const auto of = [&](uint32_t flags) {
      return evaluate(GRADUS_OP_MAP_RANGE, {0.9f, 0.5f, 0.5f, 0.25f, 0.75f, 4.0f}, mode | flags).x;
    };
    EXPECT_EQ(of(0), 0.0f) << mode;
    EXPECT_EQ(of(8), 0.25f) << mode;
    EXPECT_EQ(of(16), 0.25f) << mode;
  }
}

TEST(NodeNormal, TheDirectionHasUnitLength) {
  expect_near(evaluate(GRADUS_OP_NORMAL_DOT, {Vec3(0, 0, 2)}, 0, {0.0f, 0.6f, 1.8f}, 1), Rgb(0.948683f));
  expect_near(evaluate(GRADUS_OP_NORMAL_DOT, {Vec3(0, 0, 2)}, 0, {0.0f, 0.6f, 1.8f}, 0),
              Rgb(0.0f, 0.316228f, 0.948683f));
  expect_near(evaluate(GRADUS_OP_NORMAL_DOT, {Vec3(0.0f)}, 0, {0.0f, 0.6f, 1.8f}, 1), Rgb(0.0f));
}

TEST(NodeColor, ModelsInvertEachOther) {
  for (const Vec3& c : {Vec3(0.2f, 0.7f, 0.4f), Vec3(1, 0, 0), Vec3(0.5f), Vec3(0.9f, 0.1f, 0.8f)}) {
    for (const uint32_t model : {GRADUS_COLOR_HSV, GRADUS_COLOR_HSL}) {
      ProgramBuilder b;
      const int parts = b.add(GRADUS_OP_SEPARATE, {c}, model);
      const int whole = b.add(GRADUS_OP_COMBINE, {In::from(parts, 0), In::from(parts, 1), In::from(parts, 2)}, model);
      const int emission = b.add(GRADUS_OP_EMISSION, {In::from(whole), In(1.0f)});
      expect_near(run(b.compile(emission)->surface).emission, c);
    }
  }
}

TEST(NodeColor, BlendModes) {
  const Vec3 a(0.2f, 0.5f, 0.8f), b(0.6f, 0.3f, 0.9f);
  const float t = 0.4f;
  const auto of = [&](uint32_t mode) { return evaluate(GRADUS_OP_MIX_COLOR, {t, a, b}, mode); };
  expect_near(of(GRADUS_BLEND_MIX), glm::mix(a, b, t));
  expect_near(of(GRADUS_BLEND_MULTIPLY), glm::mix(a, a * b, t));
  expect_near(of(GRADUS_BLEND_SCREEN), Vec3(1.0f) - (Vec3(1.0f - t) + (Vec3(1.0f) - b) * t) * (Vec3(1.0f) - a));
  expect_near(of(GRADUS_BLEND_DIFFERENCE), glm::mix(a, glm::abs(a - b), t));
  expect_near(of(GRADUS_BLEND_DIVIDE), glm::mix(a, a / b, t));
  expect_near(of(GRADUS_BLEND_LINEAR_LIGHT), a + (b * 2.0f - 1.0f) * t);
  expect_near(evaluate(GRADUS_OP_MIX_COLOR, {1.0f, Vec3(2.0f), Vec3(3.0f)}, GRADUS_BLEND_ADD | 32), Vec3(1.0f));
}

// Regression: candles were a tenth too pale and had negative blue light; beyond 12,000 K, the maximum of Cycles' table,
// the colours still changed.
TEST(NodeColor, BlackBodiesHaveTheColoursOfCycles) {
  const auto of = [](float kelvin) { return evaluate(GRADUS_OP_BLACKBODY, {kelvin}); };
  expect_near(of(700.0f), Rgb(5.4133f, 0.0f, 0.0f), 0.01f);
  expect_near(of(1500.0f), Rgb(3.2643f, 0.4340f, 0.0f), 0.01f);
  expect_near(of(3000.0f), Rgb(1.7708f, 0.8443f, 0.2722f), 0.01f);
  expect_near(of(6500.0f), Rgb(1.0426f, 0.9841f, 1.0353f), 0.01f);
  expect_near(of(20000.0f), Rgb(0.8263f, 0.9945f, 1.5663f), 0.01f);
}

TEST(NodeTables, RampInterpolatesOrNot) {
  const std::vector<float> table = {0, 0, 0, 1, 1, 0.5f, 0, 0, 2, 1, 1, 1};
  expect_near(evaluate(GRADUS_OP_RAMP, {0.25f}, 0, table), Rgb(0.5f, 0.25f, 0.0f));
  expect_near(evaluate(GRADUS_OP_RAMP, {0.6f}, 1, table), Rgb(1.0f, 0.5f, 0.0f));
  expect_near(evaluate(GRADUS_OP_RAMP, {7.0f}, 0, table), Rgb(2.0f, 1.0f, 1.0f));
  expect_near(evaluate(GRADUS_OP_RAMP, {0.25f}, 0, table, 1), Rgb(0.5f));
}

TEST(NodeTables, CurvesExtrapolateOrNot) {
  const auto of = [](float x, float extrapolate) {
    return evaluate(GRADUS_OP_CURVES, {1.0f, x}, GRADUS_CURVES_FLOAT, {-1.0f, 1.0f, extrapolate, 0.0f, 1.0f, 4.0f}).x;
  };
  EXPECT_NEAR(of(-0.5f, 0.0f), 0.5f, 1e-5f);
  EXPECT_NEAR(of(0.5f, 0.0f), 2.5f, 1e-5f);
  EXPECT_NEAR(of(3.0f, 0.0f), 4.0f, 1e-5f);
  EXPECT_NEAR(of(2.0f, 1.0f), 7.0f, 1e-5f);
  EXPECT_NEAR(of(-2.0f, 1.0f), -1.0f, 1e-5f);
}

// Gradient noise is 0 at lattice points, continuous, and has mean 0.
TEST(NodeNoise, Properties) {
  for (int i = -3; i <= 3; i++) {
    const auto x = static_cast<float>(i);
    EXPECT_NEAR(shading::signed_noise(x), 0.0f, 1e-6f);
    EXPECT_NEAR(shading::signed_noise(Vec3(x, 2.0f, -1.0f)), 0.0f, 1e-6f);
    EXPECT_NEAR(shading::signed_noise(Vec3(x - 1e-4f, 0.3f, 0.7f)), shading::signed_noise(Vec3(x + 1e-4f, 0.3f, 0.7f)),
                2e-3f);
    EXPECT_NEAR(shading::signed_noise(Vec4(x - 1e-4f, 0.3f, 0.7f, 0.2f)),
                shading::signed_noise(Vec4(x + 1e-4f, 0.3f, 0.7f, 0.2f)), 2e-3f);
  }
  double sum = 0.0;
  for (int i = 0; i < 20000; i++) sum += shading::signed_noise(Vec3(0.37f, 0.73f, 0.51f) * static_cast<float>(i));
  EXPECT_NEAR(sum / 20000.0, 0.0, 0.01);
}

// Compares eight SIMD lanes with the definition, corner by corner.
TEST(NodeNoise, LanesEqualTheDefinition) {
  const auto fade = [](float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); };
  const auto corner = [](const Vec3& cell, const Vec3& d) {
    const auto at = [&](int k) { return static_cast<uint32_t>(static_cast<int32_t>(cell[k])); };
    const uint32_t h = shading::lattice_hash(at(0), at(1), at(2)) & 15u;
    const float u = h < 8u ? d.x : d.y, v = h < 4u ? d.y : (h == 12u || h == 14u ? d.x : d.z);
    return (h & 1u ? -u : u) + (h & 2u ? -v : v);
  };
  for (int i = 0; i < 500; i++) {
    const Vec3 p = Vec3(0.731f, -1.377f, 0.519f) * static_cast<float>(i - 250);
    const Vec3 cell = glm::floor(p), d = p - cell;
    float expected = 0.0f;
    for (int k = 0; k < 8; k++) {
      const Vec3 step(static_cast<float>(k & 1), static_cast<float>(k >> 1 & 1), static_cast<float>(k >> 2));
      float weight = 1.0f;
      for (int axis = 0; axis < 3; axis++) weight *= step[axis] > 0.0f ? fade(d[axis]) : 1.0f - fade(d[axis]);
      expected += weight * corner(cell + step, d - step);
    }
    EXPECT_NEAR(shading::signed_noise(p), 0.982f * expected, 1e-5f) << i;
  }
}

TEST(NodePatterns, CheckerAndGradient) {
  const Vec3 red(1, 0, 0), blue(0, 0, 1);
  expect_near(evaluate(GRADUS_OP_CHECKER, {Vec3(0.5f), red, blue, 1.0f}), blue);
  expect_near(evaluate(GRADUS_OP_CHECKER, {Vec3(1.5f, 0.5f, 0.5f), red, blue, 1.0f}), red);
  expect_near(evaluate(GRADUS_OP_GRADIENT, {Vec3(0.5f, 0.0f, 0.0f)}, GRADUS_GRADIENT_SPHERICAL), Rgb(0.499999f));
  expect_near(evaluate(GRADUS_OP_GRADIENT, {Vec3(-1.0f, 0.0f, 0.0f)}, GRADUS_GRADIENT_LINEAR), Rgb(0.0f));
}

TEST(NodeRay, FresnelAtNormalIncidenceAndFromInside) {
  shading::ShadeContext c;
  expect_near(evaluate(GRADUS_OP_FRESNEL, {1.5f, 0.0f}, 0, {}, 0, c), Rgb(0.04f), 1e-6f);
  c.wo = glm::normalize(Vec3(1.0f, 0.0f, 0.5f));  // beyond the critical angle of glass
  c.backfacing = true;
  expect_near(evaluate(GRADUS_OP_FRESNEL, {1.5f, 0.0f}, 0, {}, 0, c), Rgb(1.0f));
}

TEST(NodeRay, LightPathReadsTheRay) {
  shading::ShadeContext c;
  c.ray.flags = shading::kRayShadow | shading::kRayTransmission;
  c.ray.length = 2.5f;
  c.ray.depth = 3;
  const auto of = [&](uint32_t mode) { return evaluate(GRADUS_OP_LIGHT_PATH, {}, mode, {}, 0, c).x; };
  EXPECT_EQ(of(GRADUS_LIGHT_PATH_CAMERA), 0.0f);
  EXPECT_EQ(of(GRADUS_LIGHT_PATH_SHADOW), 1.0f);
  EXPECT_EQ(of(GRADUS_LIGHT_PATH_TRANSMISSION), 1.0f);
  EXPECT_EQ(of(GRADUS_LIGHT_PATH_LENGTH), 2.5f);
  EXPECT_EQ(of(GRADUS_LIGHT_PATH_DEPTH), 3.0f);
}

// Normals face the viewer inside a program, and point outwards in lobes with two sides.
TEST(NodeClosures, GlassNormalsPointOutwards) {
  ProgramBuilder b;
  const auto m = b.compile(b.add(GRADUS_OP_GLASS, {Vec3(1.0f), 0.0f, 1.5f}));
  shading::ShadeContext c;
  c.backfacing = true;
  const shading::ShadeResult r = run(m->surface, c);
  ASSERT_EQ(r.closures.count(), 1);
  expect_near(r.closures.lobe(0).normal, Vec3(0, 0, -1));
}

TEST(NodeClosures, MetalHasNoDiffuse) {
  ProgramBuilder b;
  std::vector<In> inputs(21, In(0.0f));
  inputs[0] = In(Vec3(0.8f, 0.4f, 0.2f));
  inputs[1] = In(1.0f);
  inputs[2] = In(0.3f);
  inputs[3] = In(1.5f);
  inputs[6] = In(1.0f);
  const shading::ShadeResult r = run(b.compile(b.add(GRADUS_OP_PRINCIPLED, inputs))->surface);
  ASSERT_EQ(r.closures.count(), 1);
  EXPECT_EQ(r.closures.lobe(0).fresnel, bsdf::FresnelType::PrincipledMetal);
}

TEST(NodeClosures, EmissionUnderCoatIsTheSameAlone) {
  ProgramBuilder b;
  std::vector<In> inputs(21, In(0.0f));
  inputs[0] = In(0.5f);
  inputs[10] = In(0.8f);
  inputs[11] = In(0.2f);
  inputs[12] = In(1.5f);
  inputs[13] = In(Vec3(0.4f, 0.9f, 0.7f));
  inputs[17] = In(Vec3(3.0f, 2.0f, 1.0f));
  const auto m = b.compile(b.add(GRADUS_OP_PRINCIPLED, inputs));
  shading::ShadeContext c;
  c.wo = glm::normalize(Vec3(0.5f, 0.2f, 0.6f));
  const Rgb whole = run(m->surface, c).emission, alone = run(m->emission, c).emission;
  expect_near(whole, alone);
  EXPECT_LT(alone.x, 3.0f * 0.8f);
}

// A luminaire whose intensity is 10·vertical + horizontal angle, with both in radians, down to the horizon.
std::vector<float> ies_floats(int columns, int rows) {
  std::vector<float> floats{float(columns)};
  for (int i = 0; i < columns; ++i) floats.push_back(2.0f * kPi * float(i) / float(columns - 1));
  for (int i = 0; i < rows; ++i) floats.push_back(0.5f * kPi * float(i) / float(rows - 1));
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k) floats.push_back(10.0f * floats[1 + columns + k] + floats[1 + i]);
  return floats;
}

float ies_of(float vertical, float horizontal, float strength = 1.0f, uint32_t mode = 0) {
  const Vec3 direction(std::sin(vertical) * std::sin(horizontal - kPi), std::sin(vertical) * std::cos(horizontal - kPi),
                       -std::cos(vertical));
  return evaluate(GRADUS_OP_IES, {direction, strength}, mode, ies_floats(9, 7)).x;
}

TEST(NodeIes, IsLinearBetweenLinearValues) {
  // The middle of the table: at its ends the spline is not linear.
  for (const float vertical : {0.3f, 0.6f, 1.1f})
    for (const float horizontal : {1.0f, 2.5f, 4.0f, 5.2f})
      EXPECT_NEAR(ies_of(vertical, horizontal, 2.0f), 2.0f * (10.0f * vertical + horizontal), 1e-3f);
}

TEST(NodeIes, EndsWithItsTable) {
  EXPECT_EQ(ies_of(1.6f, 2.0f), 0.0f);
  EXPECT_EQ(ies_of(kPi, 2.0f), 0.0f);
  EXPECT_NEAR(evaluate(GRADUS_OP_IES, {Vec3(0, 0, -1), 1.0f}, 0, ies_floats(9, 7)).x, kPi, 1e-3f);  // atan2(0, 0) = 0
}

// In the middle of two angles a spline through a, b, c, d is (9 (b + c) - a - d) / 16.
TEST(NodeIes, ContinuesAsEachVersionOfBlenderDoes) {
  constexpr float kStep = kPi / 4.0f;  // between columns, which is also the step of the intensity
  const float base = 10.0f * 0.6f, first = base, second = base + kStep;
  const float last = base + 8.0f * kStep, before_last = base + 7.0f * kStep;
  const float before[] = {before_last, 0.0f, first}, after[] = {second, 0.0f, before_last};
  for (uint32_t mode = 0; mode < 3; ++mode) {
    EXPECT_NEAR(ies_of(0.6f, 0.5f * kStep, 1.0f, mode),
                (9.0f * (first + second) - before[mode] - second - kStep) / 16.0f, 1e-3f)
        << mode;
    EXPECT_NEAR(ies_of(0.6f, 7.5f * kStep, 1.0f, mode),
                (9.0f * (before_last + last) - before_last + kStep - after[mode]) / 16.0f, 1e-3f)
        << mode;
  }
}

TEST(NodeIes, RefusesTablesOfAnotherSize) {
  const auto is_table = [](const std::vector<float>& floats) {
    return shading::ies_table(floats.data(), floats.size()).has_value();
  };
  std::vector<float> floats = ies_floats(9, 7);
  EXPECT_TRUE(is_table(floats));
  floats.pop_back();
  for (const std::vector<float>& other : {floats, {}, {NAN}, {1e30f, 0.0f}, {-1.0f}, {1.0f, 0, 0, 0, 0, 0}})
    EXPECT_FALSE(is_table(other)) << other.size();
}

}  // namespace
}  // namespace gradus::test::ops_test
