// Interpolation between matrices: rotations stay rotations, and straight motion stays straight.
#include "geometry/matrix_keys.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

namespace gradus::matrix_keys_test {
namespace {

constexpr double kQuarter = 1.5707963267948966;

glm::dmat4 turn(double angle, const glm::dvec3& axis = glm::dvec3(0, 0, 1)) {
  return glm::rotate(glm::dmat4(1.0), angle, axis);
}

TEST(MatrixKeys, AWheelStaysRound) {
  const geometry::MatrixKeys keys({turn(0.0), turn(kQuarter), turn(2 * kQuarter)});
  for (int i = 0; i <= 100; ++i) {
    const float time = float(i) / 100.0f;
    const Vec3 rim = Vec3(keys.at(time) * Vec4(1, 0, 0, 1));
    EXPECT_NEAR(glm::length(rim), 1.0f, 4e-4f);
    const double angle = 2 * kQuarter * i / 100.0;
    EXPECT_NEAR(rim.x, std::cos(angle), 1e-3);
    EXPECT_NEAR(rim.y, std::sin(angle), 1e-3);
  }
}

TEST(MatrixKeys, PassesThroughItsKeysExactly) {
  const std::vector<glm::dmat4> given = {
      turn(0.3), glm::translate(turn(1.9, glm::normalize(glm::dvec3(1, 2, 3))), glm::dvec3(5, 1, 0)),
      glm::scale(turn(0.2), glm::dvec3(1, -2, 3)), turn(-0.5)};
  const geometry::MatrixKeys keys(given);
  for (size_t i = 0; i < given.size(); ++i) {
    const Mat4 found = keys.at(float(i) / float(given.size() - 1));
    for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(found[c] - Vec4(given[i][c])), 2e-6f) << i;
  }
}

TEST(MatrixKeys, StraightMotionNeedsNoMoreKeys) {
  const glm::dmat4 a = glm::scale(turn(0.7), glm::dvec3(1, 2, 3)),
                   b = glm::scale(glm::translate(turn(0.7), glm::dvec3(1, 2, 3)), glm::dvec3(2));
  const geometry::MatrixKeys keys({a, b});
  EXPECT_EQ(keys.keys().size(), 2u);
  const Mat4 middle = keys.at(0.5f);
  for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(middle[c] - Vec4((a[c] + b[c]) * 0.5)), 1e-6f);
}

// A mirrored object rotates like any other. If its handedness changes between two keys, there is no rotation between
// them.
TEST(MatrixKeys, MirroredObjectsRotate) {
  const glm::dmat4 mirror = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
  const geometry::MatrixKeys keys({mirror, turn(kQuarter) * mirror});
  const Vec3 middle = Vec3(keys.at(0.5f) * Vec4(1, 0, 0, 0));
  EXPECT_LT(glm::length(middle - Vec3(-std::sqrt(0.5f), -std::sqrt(0.5f), 0)), 1e-3f);
  const geometry::MatrixKeys inside_out({glm::dmat4(1.0), mirror});
  EXPECT_EQ(inside_out.keys().size(), 2u);
  EXPECT_EQ(inside_out.at(0.5f)[0].x, 0.0f);
}

TEST(MatrixKeys, NeverExceedsTheMaximumOfEmbree) {
  std::vector<glm::dmat4> many;
  for (uint32_t i = 0; i < geometry::kMaxShutterKeys; ++i) many.push_back(turn(2.0 * i));
  EXPECT_EQ(geometry::MatrixKeys(many).keys().size(), geometry::kMaxShutterKeys);
  many.resize(100);
  EXPECT_LE(geometry::MatrixKeys(many).keys().size(), geometry::kMaxShutterKeys);
  EXPECT_LE(geometry::MatrixKeys({turn(0.0), turn(3.1)}).keys().size(), geometry::kMaxShutterKeys);
}

TEST(MatrixKeys, KeyPlaceHoldsAtBothEnds) {
  EXPECT_EQ(geometry::key_place(0.0f, 3).before, 0u);
  EXPECT_EQ(geometry::key_place(1.0f, 3).before, 1u);
  EXPECT_EQ(geometry::key_place(1.0f, 3).share, 1.0f);
  EXPECT_EQ(geometry::key_place(0.75f, 3).share, 0.5f);
}

}  // namespace
}  // namespace gradus::matrix_keys_test
