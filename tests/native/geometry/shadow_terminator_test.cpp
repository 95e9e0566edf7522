// Shadow rays of faceted meshes with smooth normals start on the smooth surface that the mesh approximates.
#include "geometry/shadow_terminator.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/path_scene.h"

namespace gradus::test::shadow_terminator_test {
namespace {

constexpr float kReplayed = 0.3f;

std::shared_ptr<const scene::Snapshot> ball(float offset, bool smooth, const Mat4& place = Mat4(1.0f)) {
  PathScene scene;
  scene.scene.shadow_terminator_offset = offset;
  scene.place = place;
  scene.ball(Vec3(0.0f), 1.0f, scene.material(matte(Rgb(1.0f))), 8, smooth);
  scene.camera(Vec3(0, 0, 4), Vec3(0.0f), 1.0f);
  return scene.context(test_settings(4, 4)).snapshot;
}

// Returns the points where rays from all directions towards the centre meet the ball.
std::vector<geometry::SurfacePoint> points(const scene::Snapshot& scene, const Vec3& centre = Vec3(0.0f)) {
  std::vector<geometry::SurfacePoint> found;
  for (int i = 0; i < 400; ++i) {
    const float z = 1.0f - (2.0f * float(i) + 1.0f) / 400.0f, around = 2.399963f * float(i);
    const Vec3 out(std::sqrt(1.0f - z * z) * std::cos(around), std::sqrt(1.0f - z * z) * std::sin(around), z);
    geometry::Hit hit;
    if (scene.intersect(Ray{centre + 10.0f * out, 0.0f, -out, kInfinity}, GRADUS_VISIBLE_ALL, &hit))
      found.push_back(scene.surface_point(hit));
  }
  return found;
}

// Returns a direction just above the tangent plane of the smooth surface.
Vec3 grazing(const Vec3& normal, float side = 1.0f) {
  const Vec3 tangent = glm::normalize(glm::cross(normal, std::fabs(normal.x) < 0.7f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  return glm::normalize(side * tangent + 0.02f * normal);
}

TEST(ShadowTerminator, ALightBehindTheFacetIsVisibleAsFromTheSmoothSurface) {
  const auto scene = ball(kReplayed, true);
  int behind = 0;
  for (const geometry::SurfacePoint& p : points(*scene)) {
    for (const float side : {-1.0f, 1.0f}) {
      const Vec3 along = grazing(p.shading_normal, side);
      if (glm::dot(along, p.geometric_normal) > 0.0f) continue;
      ++behind;
      const Vec3 start = geometry::shadow_origin(*scene, p, along);
      EXPECT_FALSE(scene->occluded(Ray{start, 0.0f, along, kInfinity}));
      EXPECT_TRUE(scene->occluded(
          Ray{geometry::offset_origin(p, along), 0.0f, along, kInfinity}));  // a shadow ray from the facet itself
    }
  }
  EXPECT_GT(behind, 100);
}

// The offset equals the height of the sphere over its facets within a factor of two.
TEST(ShadowTerminator, RaysStartOnTheSphere) {
  const auto scene = ball(kReplayed, true);
  for (const geometry::SurfacePoint& p : points(*scene)) {
    const float height =
        glm::length(geometry::shadow_origin(*scene, p, grazing(p.shading_normal))) - glm::length(p.position);
    const float sphere = 1.0f - glm::length(p.position);
    EXPECT_GE(height, 0.4f * sphere - 1e-5f);
    EXPECT_LE(height, 2.5f * sphere + 1e-5f);
  }
}

TEST(ShadowTerminator, NothingChangesFarFromTheTerminatorOrOnFlatFacesOrWithoutOffset) {
  const auto smooth = ball(kReplayed, true), flat = ball(kReplayed, false), off = ball(0.0f, true);
  for (const geometry::SurfacePoint& p : points(*smooth))
    EXPECT_EQ(geometry::shadow_origin(*smooth, p, p.shading_normal), geometry::offset_origin(p, p.shading_normal));
  for (const auto& scene : {flat, off}) {
    for (const geometry::SurfacePoint& p : points(*scene)) {
      const Vec3 along = grazing(p.shading_normal);
      EXPECT_EQ(geometry::shadow_origin(*scene, p, along), geometry::offset_origin(p, along));
      EXPECT_TRUE(geometry::leaves_facet(p, along));
    }
  }
}

// Stretched, rotated, mirrored and far away: the offset points outwards, apart from rounding.
TEST(ShadowTerminator, InstancesAreOffsetOutwards) {
  Mat4 place(1.0f);
  place[0] = Vec4(-2.0f, 0.3f, 0.0f, 0.0f);
  place[1] = Vec4(0.0f, 0.5f, 0.4f, 0.0f);
  place[3] = Vec4(30.0f, -20.0f, 10.0f, 1.0f);
  const auto scene = ball(kReplayed, true, place);
  const auto all = points(*scene, Vec3(30.0f, -20.0f, 10.0f) - scene->origin);
  ASSERT_GT(all.size(), 300u);
  for (const geometry::SurfacePoint& p : all) {
    const Vec3 lift = geometry::shadow_origin(*scene, p, grazing(p.shading_normal)) - p.position;
    EXPECT_GE(glm::dot(lift, p.geometric_normal), 0.0f);
    EXPECT_LT(glm::length(lift), 0.5f);
  }
}

// A coarse ball under a sun from the side is lit up to the terminator of a fine one.
TEST(ShadowTerminator, BlackFacetsAtTheTerminatorOfACoarseBall) {
  const auto image = [](float offset, int rings) {
    PathScene scene;
    scene.scene.shadow_terminator_offset = offset;
    scene.ball(Vec3(0.0f), 1.0f, scene.material(matte(Rgb(1.0f))), rings, true);
    Mat4 from_the_right(1.0f);  // and from a little behind, so that the terminator crosses facets
    from_the_right[2] = Vec4(glm::normalize(Vec3(1.0f, 0.0f, -0.02f)), 0.0f);
    from_the_right[0] = Vec4(glm::cross(Vec3(0, 1, 0), Vec3(from_the_right[2])), 0.0f);
    scene.light(make_light(GRADUS_LIGHT_SUN, from_the_right, Rgb(1.0f)));
    scene.camera(Vec3(0, 0, 4), Vec3(0.0f), 1.6f, GRADUS_CAMERA_ORTHOGRAPHIC);
    const integrator::IntegratorContext context = scene.context(test_settings(32, 32));
    film::Film film = make_test_film(context.settings, false);
    sample_film(*integrator::make_path_integrator(context), 0, 16, &film);
    return film::read_images(film, 0).primal;
  };
  const auto fine = image(0.0f, 200), coarse = image(0.0f, 5), lifted = image(kReplayed, 5);
  int black = 0, black_lifted = 0, lit_behind = 0;
  for (size_t i = 0; i < fine.size(); ++i) {
    black += fine[i] > 0.005f && coarse[i] == 0.0f;
    black_lifted += fine[i] > 0.005f && lifted[i] == 0.0f;
    lit_behind += fine[i] == 0.0f && lifted[i] > 0.01f;
  }
  EXPECT_GT(black, 100);
  EXPECT_LT(black_lifted, black / 3);  // points at half the height of the sphere do not see over every edge
  EXPECT_LT(lit_behind, 10);
}

}  // namespace
}  // namespace gradus::test::shadow_terminator_test
