#include "geometry/rays4.h"

#include <random>

#include <gtest/gtest.h>

#include "light/light_rays4.h"
#include "path/segment.h"

namespace gradus::test::rays4_test {
namespace {

Vec3 lane(const geometry::Lanes3& v, int i) { return Vec3(v.x[i], v.y[i], v.z[i]); }

class Rays4Test : public testing::Test {
 protected:
  float number() { return std::uniform_real_distribution<float>(-1.0f, 1.0f)(random_); }
  Vec3 vector() { return Vec3(number(), number(), number()); }
  Vec3 unit() { return glm::normalize(vector() + Vec3(0.0f, 0.0f, 1e-3f)); }
  geometry::SurfacePoint point(const Vec3& position) {
    geometry::SurfacePoint p;
    p.position = position;
    p.geometric_normal = unit();
    p.error = 1e-6f * (1.5f + number());
    return p;
  }
  void expect_same(const Ray& ray, const geometry::Rays4& rays, int i) {
    EXPECT_LT(glm::length(ray.origin - lane(rays.origin, i)), 5e-7f);
    EXPECT_LT(glm::length(ray.direction - lane(rays.direction, i)), 5e-6f);
    EXPECT_NEAR(ray.t_max, rays.t_max[i], 2e-6f);
  }
  std::mt19937 random_{3};
};

TEST_F(Rays4Test, LeaveSurfacesAndArriveLikeSingleRays) {
  for (int n = 0; n < 1000; ++n) {
    const geometry::SurfacePoint from[4] = {point(vector()), point(Vec3(0.0f)), point(vector()), point(vector())};
    const geometry::SurfacePoint to = point(vector() + Vec3(2.0f, 0.0f, 0.0f));
    Vec3 d[4];
    for (int i = 0; i < 4; ++i) d[i] = glm::normalize(to.position - from[i].position);
    const geometry::Rays4 rays = geometry::spawn_rays_to(geometry::gather(from[0], from[1], from[2], from[3], 0.0f),
                                                         geometry::lanes(d[0], d[1], d[2], d[3]), to);
    for (int i = 0; i < 4; ++i) expect_same(path::spawn_ray_to(from[i], to), rays, i);
  }
}

TEST_F(Rays4Test, AreEmptyBetweenPointsThatRoundingCannotSeparate) {
  geometry::SurfacePoint a, b;
  a.error = b.error = 1e-5f;
  b.geometric_normal = Vec3(0, 0, -1);
  b.position = Vec3(0, 0, 1e-6f);
  const geometry::Rays4 rays =
      geometry::spawn_rays_to(geometry::gather(a, a, a, a, 0.0f), geometry::same(Vec3(0, 0, 1)), b);
  EXPECT_LT(path::spawn_ray_to(a, b).t_max, 0.0f);
  for (int i = 0; i < 4; ++i) EXPECT_LT(rays.t_max[i], 0.0f);
}

TEST_F(Rays4Test, ReachEmittersOfAllKindsLikeSingleShadowRays) {
  light::LightPoint light_points[3];
  light_points[0].kind = light::LightKind::AnalyticLight;
  light_points[0].normal = Vec3(0, 0, -1);
  light_points[1].kind = light::LightKind::Triangle;
  light_points[1].error = 1e-6f;
  light_points[1].normal = Vec3(0, 0, 1);
  light_points[2].kind = light::LightKind::World;
  light_points[2].direction = Vec3(0.6f, 0.0f, 0.8f);
  for (light::LightPoint& light_point : light_points) {
    light_point.position = Vec3(2.0f, 0.5f, 0.25f);
    geometry::SurfacePoint from[4];
    light::LightEvaluation view[4];
    for (int i = 0; i < 4; ++i) {
      from[i] = point(vector());
      view[i].distance = glm::length(light_point.position - from[i].position);
      view[i].direction = light_point.at_infinity() ? light_point.direction
                                                    : (light_point.position - from[i].position) / view[i].distance;
    }
    const geometry::Points4 points = geometry::gather(from[0], from[1], from[2], from[3], 0.0f);
    const geometry::Lanes3 direction =
        geometry::lanes(view[0].direction, view[1].direction, view[2].direction, view[3].direction);
    const geometry::Lanes distance{view[0].distance, view[1].distance, view[2].distance, view[3].distance};
    const geometry::Rays4 rays =
        light::rays_to_light(geometry::offset_origins(points, direction), points, direction, distance, light_point);
    for (int i = 0; i < 4; ++i) {
      const Ray one =
          light::ray_to_light(geometry::offset_origin(from[i], view[i].direction), from[i], light_point, view[i]);
      if (light_point.at_infinity()) {
        EXPECT_EQ(rays.t_max[i], kInfinity);
        EXPECT_EQ(lane(rays.direction, i), one.direction);
      } else {
        expect_same(one, rays, i);
      }
    }
  }
}

}  // namespace
}  // namespace gradus::test::rays4_test
