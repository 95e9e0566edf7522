#include "light/spherical_triangle.h"

#include <cmath>

#include <gtest/gtest.h>

namespace gradus::spherical_triangle_test {
namespace {

using Corners = std::array<Vec3, 3>;

// Returns ∫ω dω over a spherical polygon: half the sum over its edges of angle times normal (Lambert's formula for its
// irradiance).
glm::dvec3 first_moment(const Corners& corners, const Vec3& from) {
  glm::dvec3 v[3], sum(0.0);
  for (int i = 0; i < 3; ++i) v[i] = glm::normalize(glm::dvec3(corners[i]) - glm::dvec3(from));
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 n = glm::cross(v[i], v[(i + 1) % 3]);
    sum += 0.5 * std::atan2(glm::length(n), glm::dot(v[i], v[(i + 1) % 3])) * glm::normalize(n);
  }
  return sum;
}

const Corners kTriangles[] = {
    {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},                        // an octant
    {Vec3(-3, -2, 1), Vec3(3, -2, 1), Vec3(0, 3, 1)},                     // close and large
    {Vec3(-0.1f, 0, 2), Vec3(0.1f, 0, 2), Vec3(0, 0.1f, 2)},              // small
    {Vec3(-1, 0.02f, 0.3f), Vec3(1, 0.02f, 0.3f), Vec3(0, 0.03f, 0.3f)},  // thin
    {Vec3(0.2f, -1, 0.05f), Vec3(0.2f, 1, 0.05f), Vec3(3, 0, 0.1f)},      // grazing
};

TEST(SphericalTriangle, OctantIsAnEighthOfTheSphere) {
  EXPECT_NEAR(light::SphericalTriangle(kTriangles[0], Vec3(0.0f)).solid_angle(), 0.5f * kPi, 1e-6f);
}

TEST(A3_SphericalTriangle, SamplesAreUniformInSolidAngle) {
  constexpr int n = 512;
  for (const Corners& corners : kTriangles) {
    const Vec3 from(0.01f, -0.02f, 0.0f);
    const light::SphericalTriangle seen(corners, from);
    ASSERT_TRUE(seen.usable());
    glm::dvec3 mean(0.0);
    for (int i = 0; i < n * n; ++i) {
      mean += glm::dvec3(seen.sample(Vec2((i % n + 0.5f) / n, (i / n + 0.5f) / n))) / double(n * n);
    }
    const glm::dvec3 expected = first_moment(corners, from);
    const double solid_angle = seen.solid_angle();
    const double sign = glm::dot(mean, expected) < 0.0 ? -1.0 : 1.0;
    EXPECT_LT(glm::length(mean * solid_angle - sign * expected) / solid_angle, 1e-3);
  }
}

// The first coordinate is the share of the solid angle that lies before it.
TEST(A3_SphericalTriangle, FirstCoordinateIsAShareOfTheSolidAngle) {
  for (const Corners& corners : kTriangles) {
    const light::SphericalTriangle seen(corners, Vec3(0.0f));
    for (const float u : {0.1f, 0.5f, 0.8f}) {
      const Corners part = {corners[0], corners[1], seen.sample(Vec2(u, 1.0f))};
      EXPECT_NEAR(light::SphericalTriangle(part, Vec3(0.0f)).solid_angle() / seen.solid_angle(), u, 2e-3f);
    }
  }
}

TEST(SphericalTriangle, DirectionsFindTheirBarycentricCoordinates) {
  for (const Corners& p : kTriangles) {
    const Vec2 b(0.2f, 0.7f);
    const Vec3 target = p[0] * (1.0f - b.x - b.y) + p[1] * b.x + p[2] * b.y;
    const Vec2 found = light::barycentric_towards(p, Vec3(0.0f), glm::normalize(target));
    EXPECT_NEAR(found.x, b.x, 1e-4f);
    EXPECT_NEAR(found.y, b.y, 1e-4f);
  }
}

}  // namespace
}  // namespace gradus::spherical_triangle_test
