// Panoramic projections against closed forms in double, as inverses of each other, at edges and poles; stereo.
#include "camera/panorama.h"

#include <gtest/gtest.h>

#include "camera/camera.h"
#include "scene/scene_fixture.h"

namespace gradus::test::panorama_test {
namespace {

constexpr uint32_t kWidth = 640, kHeight = 480;
constexpr double kTau = 6.283185307179586;

struct Projection {
  const char* name;
  GradusPanorama type;
  float window[4];
  float fov;
};

constexpr Projection kProjections[] = {
    {"equirectangular", GRADUS_PANORAMA_EQUIRECTANGULAR, {-3.14159265f, 3.14159265f, -1.57079633f, 1.57079633f}, 0.0f},
    {"limited", GRADUS_PANORAMA_EQUIRECTANGULAR, {2.0f, 4.5f, -0.5f, 1.2f}, 0.0f},
    {"cube face", GRADUS_PANORAMA_CUBE_FACE, {-0.785398163f, 0.785398163f, -0.785398163f, 0.785398163f}, 0.0f},
    {"mirror ball", GRADUS_PANORAMA_MIRROR_BALL, {-1.0f, 1.0f, -1.0f, 1.0f}, 0.0f},
    {"equidistant",
     GRADUS_PANORAMA_FISHEYE_EQUIDISTANT,
     {-1.57079633f, 1.57079633f, -1.57079633f, 1.57079633f},
     3.14159265f},
    {"equidistant, all around",
     GRADUS_PANORAMA_FISHEYE_EQUIDISTANT,
     {-3.14159265f, 3.14159265f, -3.0f, 3.0f},
     6.28318531f},
    {"equisolid", GRADUS_PANORAMA_FISHEYE_EQUISOLID, {-1.7f, 1.7f, -1.1f, 1.1f}, 3.14159265f},
    {"polynomial", GRADUS_PANORAMA_FISHEYE_POLYNOMIAL, {-18.0f, 18.0f, -12.0f, 12.0f}, 3.14159265f},
    {"bent polynomial", GRADUS_PANORAMA_FISHEYE_POLYNOMIAL, {-18.0f, 18.0f, -12.0f, 12.0f}, 2.5f},
    {"cylinder", GRADUS_PANORAMA_CYLINDER, {-3.14159265f, 3.14159265f, -1.0f, 1.5f}, 0.0f},
};

GradusCamera make_camera(const Projection& p, const Mat4& pose = Mat4(1.0f)) {
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  camera.type = GRADUS_CAMERA_PANORAMA;
  camera.panorama = p.type;
  camera.fisheye_fov = p.fov;
  const bool bent = p.fov == 2.5f;
  const float straight[5] = {-1.17e-5f, -0.019988737f, -3.3525e-6f, 3.0993e-6f, -2.61e-8f},
              curved[5] = {0.01f, -0.1f, 0.001f, 0, 0};
  std::copy_n(bent ? curved : straight, 5, camera.fisheye_polynomial);
  set_static(&camera, p.window, pose);
  return camera;
}

// Returns the closed form of the direction, in double; zero outside of the image circle.
glm::dvec3 expected_direction(const GradusCamera& c, double x, double y) {
  const double r = std::sqrt(x * x + y * y);
  double angle = 0.0;
  switch (c.panorama) {
    case GRADUS_PANORAMA_EQUIRECTANGULAR:
      return {std::cos(y) * std::sin(x), std::sin(y), -std::cos(y) * std::cos(x)};
    case GRADUS_PANORAMA_CYLINDER:
      return glm::normalize(glm::dvec3(std::sin(x), y, -std::cos(x)));
    case GRADUS_PANORAMA_CUBE_FACE:
      return glm::normalize(glm::dvec3(std::tan(x), std::tan(y), -1.0));
    case GRADUS_PANORAMA_MIRROR_BALL: {
      if (r > 1.0) return glm::dvec3(0.0);
      const glm::dvec3 normal(x, y, std::sqrt(1.0 - r * r));  // normal of the ball, seen along -z
      return glm::reflect(glm::dvec3(0, 0, -1), normal) * glm::dvec3(1, 1, -1);
    }
    case GRADUS_PANORAMA_FISHEYE_EQUIDISTANT:
      angle = r;
      break;
    case GRADUS_PANORAMA_FISHEYE_EQUISOLID:
      angle = r > 1.0 ? 10.0 : 2.0 * std::asin(r);
      break;
    default:
      for (int k = 4; k >= 0; --k) angle = angle * r - double(c.fisheye_polynomial[k]);
  }
  if (std::fabs(angle) > 0.5 * double(c.fisheye_fov)) return glm::dvec3(0.0);
  return {std::sin(angle) * x / r, std::sin(angle) * y / r, -std::cos(angle)};
}

const Mat4 kPose = translation(Vec3(3, -2, 1)) *
                   Mat4(Vec4(0.8f, 0.6f, 0, 0), Vec4(-0.6f, 0.8f, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 1));

class Panorama : public ::testing::TestWithParam<Projection> {};

TEST_P(Panorama, DirectionsAreThoseOfTheClosedForm) {
  const GradusCamera desc = make_camera(GetParam());
  std::mt19937 random(17);
  std::uniform_real_distribution<double> u(-0.02, 1.02);  // filters reach beyond the film
  int seen = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec2 p(desc.window[0] + (desc.window[1] - desc.window[0]) * float(u(random)),
                 desc.window[2] + (desc.window[3] - desc.window[2]) * float(u(random)));
    const glm::dvec3 expected = expected_direction(desc, double(p.x), double(p.y));
    Vec3 found;
    const bool sees = camera::panorama_direction(desc, p, &found);
    if (sees != (glm::length(expected) > 0.0)) {
      const double inside = glm::length(expected_direction(desc, double(p.x) * (1 - 1e-5), double(p.y) * (1 - 1e-5)));
      EXPECT_GT(inside, 0.0) << "not at the rim: " << p.x << " " << p.y;
      continue;
    }
    if (!sees) continue;
    ++seen;
    // The mirror ball is steep at its rim, which shows what lies behind it, where z is 1.
    const bool ball = GetParam().type == GRADUS_PANORAMA_MIRROR_BALL;
    EXPECT_NEAR(glm::length(glm::dvec3(found) - expected), 0.0,
                2e-6 + (ball ? 1e-7 / std::sqrt(0.5 - 0.5 * expected.z) : 0.0));
  }
  EXPECT_GT(seen, 3000);
}

TEST_P(Panorama, PointsOnRaysProjectToTheOriginOfTheRay) {
  const GradusCamera desc = make_camera(GetParam(), kPose);
  const camera::Camera camera(desc, kWidth, kHeight);
  std::mt19937 random(18);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  int seen = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec2 film(u(random) * float(kWidth), u(random) * float(kHeight));
    const Ray ray = camera.ray({film, Vec2(0.0f)});
    if (is_none(ray)) continue;
    if (desc.fisheye_polynomial[0] > 0.0f && glm::length(film - Vec2(320.0f, 240.0f)) < 5.0f)
      continue;  // the projection is not unique there
    const Vec3 relative = glm::transpose(Mat3(kPose)) * ray.direction;
    const bool at_pole =
        std::fabs(relative.y) > 0.99f || relative.z > 0.99f;  // where a pixel is no larger than the rounding error
    Vec2 back;
    ASSERT_TRUE(camera.project(ray.origin + 7.0f * ray.direction, Moment::Now, &back));
    EXPECT_LT(glm::length(camera.film_displacement(film, back)), at_pole ? 0.5f : 0.01f) << film.x << " " << film.y;
    ASSERT_TRUE(camera.project_direction(ray.direction, Moment::Now, &back));
    EXPECT_LT(glm::length(camera.film_displacement(film, back)), at_pole ? 0.5f : 0.01f) << film.x << " " << film.y;
    EXPECT_NEAR(camera.depth(ray.origin + ray.direction * 7.0f, ray.time), 7.0f, 1e-5f);
    EXPECT_EQ(ray.t_min, 0.1f);
    EXPECT_EQ(ray.t_max, 1000.0f);
    ++seen;
  }
  EXPECT_GT(seen, 1000);
}

TEST_P(Panorama, RaysOfAFilmPointMeetAtTheFocalDistance) {
  GradusCamera desc = make_camera(GetParam(), kPose);
  const camera::Camera pinhole(desc, kWidth, kHeight);
  desc.aperture_radius = 0.3f;
  desc.blades = 5;
  const camera::Camera camera(desc, kWidth, kHeight);
  std::mt19937 random(19);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  for (const Vec2 film : {Vec2(320.0f, 240.0f), Vec2(400.0f, 130.0f), Vec2(250.0f, 300.0f)}) {
    const Ray sharp = pinhole.ray({film, Vec2(0.0f)});
    ASSERT_FALSE(is_none(sharp));
    const Vec3 focus = sharp.origin + 4.0f * sharp.direction;
    for (int i = 0; i < 50; ++i) {
      const Ray ray = camera.ray({film, Vec2(u(random), u(random))});
      EXPECT_LT(glm::length(glm::cross(ray.direction, focus - ray.origin)), 1e-5f);
      EXPECT_LT(std::fabs(glm::dot(ray.origin - sharp.origin, sharp.direction)), 1e-5f)
          << "the lens lies across the direction";
      EXPECT_LE(glm::length(ray.origin - sharp.origin), 0.30001f);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Panorama, ::testing::ValuesIn(kProjections), [](const auto& info) {
  std::string name;
  for (const char c : std::string(info.param.name))
    if (std::isalpha(c)) name += c;
  return name;
});

Ray ray_at(const Projection& p, float x, float y) {
  return camera::Camera(make_camera(p), kWidth, kHeight).ray({Vec2(x * float(kWidth), y * float(kHeight)), Vec2(0.0f)});
}

void expect_direction(const Ray& ray, const Vec3& expected) { EXPECT_LT(glm::length(ray.direction - expected), 1e-5f); }

TEST(PanoramaEdges, LookInTheExpectedDirections) {
  const Projection& all_around = kProjections[0];
  expect_direction(ray_at(all_around, 0.5f, 0.5f), Vec3(0, 0, -1));
  expect_direction(ray_at(all_around, 0.75f, 0.5f), Vec3(1, 0, 0));
  expect_direction(ray_at(all_around, 0.0f, 0.5f), Vec3(0, 0, 1));
  expect_direction(ray_at(all_around, 0.3f, 1.0f), Vec3(0, 1, 0));
  expect_direction(ray_at(all_around, 0.3f, 0.0f), Vec3(0, -1, 0));
  expect_direction(ray_at(kProjections[2], 1.0f, 0.5f), glm::normalize(Vec3(1, 0, -1)));
  expect_direction(ray_at(kProjections[3], 0.5f, 0.5f), Vec3(0, 0, -1));
  expect_direction(ray_at(kProjections[4], 0.5f, 0.999999f), Vec3(0, 1, 0));
  expect_direction(ray_at(kProjections[9], 0.25f, 0.4f), Vec3(-1, 0, 0));
}

TEST(PanoramaEdges, NothingLeavesOutsideOfTheImageCircle) {
  for (const int i : {3, 4, 6, 8}) EXPECT_TRUE(is_none(ray_at(kProjections[i], 0.01f, 0.01f))) << kProjections[i].name;
  EXPECT_FALSE(is_none(ray_at(kProjections[0], 0.0f, 0.0f)));
}

TEST(PanoramaEdges, BehindACubeFaceNothingAppears) {
  const camera::Camera camera(make_camera(kProjections[2]), kWidth, kHeight);
  Vec2 film;
  EXPECT_TRUE(camera.project(Vec3(0.2f, 0.1f, -1.0f), Moment::Now, &film));
  EXPECT_FALSE(camera.project(Vec3(0.2f, 0.1f, 1.0f), Moment::Now, &film));
}

TEST(PanoramaEdges, MotionTakesTheShorterDirectionAround) {
  const camera::Camera camera(make_camera(kProjections[0]), kWidth, kHeight);
  Vec2 from, to;
  ASSERT_TRUE(camera.project(Vec3(0.01f, 0, 1), Moment::Now, &from));
  ASSERT_TRUE(camera.project(Vec3(-0.01f, 0, 1), Moment::Now, &to));
  EXPECT_GT(from.x - to.x, 600.0f);
  EXPECT_NEAR(camera.film_displacement(from, to).x, 0.02 * kWidth / kTau, 0.01);
  EXPECT_NEAR(camera.film_displacement(to, from).x, -0.02 * kWidth / kTau, 0.01);
}

TEST(PanoramaEdges, LongitudesAreThoseOfTheWindow) {
  const camera::Camera camera(make_camera(kProjections[1]), kWidth, kHeight);  // 2 to 4.5: across the seam of atan2
  Vec2 film;
  ASSERT_TRUE(camera.project(Vec3(std::sin(4.0f), 0.0f, -std::cos(4.0f)), Moment::Now, &film));
  EXPECT_NEAR(film.x, (4.0 - 2.0) / 2.5 * kWidth, 0.01);
}

// From the position and direction of the eye, by the formulae of Cycles, in double.
TEST(SphericalStereo, RaysLeaveTheEyesCircle) {
  GradusCamera desc = make_camera(kProjections[0]);
  desc.eye_offset = 0.5f;
  const camera::Camera parallel(desc, kWidth, kHeight);
  const Ray right = parallel.ray({Vec2(0.75f * kWidth, 0.5f * kHeight), Vec2(0.0f)});
  EXPECT_LT(glm::length(right.origin - Vec3(0, 0, 0.5f)), 1e-6f) << "looking right, the right eye lies behind";
  expect_direction(right, Vec3(1, 0, 0));
  desc.convergence_distance = 2.0f;
  const Ray ahead = camera::Camera(desc, kWidth, kHeight).ray({Vec2(0.5f * kWidth, 0.5f * kHeight), Vec2(0.0f)});
  EXPECT_LT(glm::length(ahead.origin - Vec3(0.5f, 0, 0)), 1e-6f);
  expect_direction(ahead, glm::normalize(Vec3(-0.5f, 0, -2)));
  desc.pole_merge_from = 1.0f;
  desc.pole_merge_to = 1.4f;
  const auto offset_at = [&](float latitude) {
    return glm::length(camera::Camera(desc, kWidth, kHeight)
                           .ray({Vec2(320.0f, (latitude / 3.14159265f + 0.5f) * kHeight), Vec2(0.0f)})
                           .origin);
  };
  EXPECT_NEAR(offset_at(0.9f), 0.5f, 1e-5f);
  EXPECT_NEAR(offset_at(1.2f), 0.5f * std::sqrt(0.5f), 1e-4f);
  EXPECT_EQ(offset_at(1.45f), 0.0f);
}

TEST(SphericalStereo, PointsOnRaysProjectToTheOriginOfTheRay) {
  std::mt19937 random(20);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  for (const float convergence : {0.0f, 2.0f})
    for (const float merge : {0.0f, 1.3f})
      for (const int projection : {0, 3, 4, -1}) {
        GradusCamera desc = make_camera(kProjections[std::max(projection, 0)], kPose);
        if (projection < 0) {
          desc.type = GRADUS_CAMERA_PERSPECTIVE;
          const float window[4] = {-1.0f, 1.0f, -0.75f, 0.75f};
          std::copy(window, window + 4, desc.window);
        }
        desc.eye_offset = -0.3f;
        desc.convergence_distance = convergence;
        desc.pole_merge_from = 0.8f;
        desc.pole_merge_to = merge;
        const camera::Camera camera(desc, kWidth, kHeight);
        for (int i = 0; i < 1000; ++i) {
          const Vec2 film((0.1f + 0.8f * u(random)) * float(kWidth), (0.1f + 0.8f * u(random)) * float(kHeight));
          const Ray ray = camera.ray({film, Vec2(0.0f)});
          if (is_none(ray)) continue;
          Vec2 back;
          ASSERT_TRUE(camera.project(ray.origin + 5.0f * ray.direction, Moment::Now, &back));
          EXPECT_LT(glm::length(camera.film_displacement(film, back)), 0.05f)
              << projection << " " << convergence << " " << merge << " " << film.x << " " << film.y;
          ASSERT_TRUE(camera.project_direction(ray.direction, Moment::Now, &back));
          EXPECT_LT(glm::length(camera.film_displacement(film, back)), 0.05f)
              << projection << " " << convergence << " " << merge << " " << film.x << " " << film.y;
        }
      }
}

}  // namespace
}  // namespace gradus::test::panorama_test
