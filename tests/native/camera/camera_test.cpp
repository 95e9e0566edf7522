// Camera against the projection of Blender's Object.calc_matrix_camera(); depth of field; A3 for the lens.
#include "camera/camera.h"

#include <gtest/gtest.h>

#include "geometry/matrix_keys.h"
#include "scene/scene_fixture.h"
#include "support/chi_square.h"
#include "support/refusal.h"

namespace gradus::test::camera_test {
namespace {

struct BlenderCamera {
  bool orthographic = false;
  float lens = 50.0f, ortho_scale = 6.0f, sensor_width = 36.0f, sensor_height = 24.0f;
  int fit = 0;  // 0 AUTO, 1 HORIZONTAL, 2 VERTICAL
  float shift_x = 0.0f, shift_y = 0.0f, aspect_x = 1.0f, aspect_y = 1.0f;
};

// Values of calc_matrix_camera() in Blender 3.4 to 5.0: m00, m11 and the position of the axis in NDC.
struct Projection {
  double m00, m11, axis_x, axis_y;
};

Projection blender_projection(const BlenderCamera& c, double w, double h) {
  const double a = double(c.aspect_y) / c.aspect_x;
  const bool horizontal = c.fit == 1 || (c.fit == 0 && w * c.aspect_x >= h * c.aspect_y);
  const double view = horizontal ? w : a * h;
  const double sensor = c.fit == 2 ? c.sensor_height : c.sensor_width;
  const double pix = c.orthographic ? c.ortho_scale / view : sensor / (c.lens * view);
  return {2 / (w * pix), 2 / (h * a * pix), -2.0 * c.shift_x * view / w, -2.0 * c.shift_y * view / (h * a)};
}

// Returns a camera with the window (see gradus.h) of this projection: ndc = m·p + axis.
GradusCamera make_camera(const BlenderCamera& c, double w, double h, const Mat4& pose) {
  const Projection p = blender_projection(c, w, h);
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  camera.type = c.orthographic ? GRADUS_CAMERA_ORTHOGRAPHIC : GRADUS_CAMERA_PERSPECTIVE;
  const float window[4] = {float((-1 - p.axis_x) / p.m00), float((1 - p.axis_x) / p.m00),
                           float((-1 - p.axis_y) / p.m11), float((1 - p.axis_y) / p.m11)};
  set_static(&camera, window, pose);
  return camera;
}

const Mat4 kPose = translation(Vec3(3, -2, 1)) *
                   Mat4(Vec4(0.8f, 0.6f, 0, 0), Vec4(-0.6f, 0.8f, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 1));

std::vector<BlenderCamera> all_cameras() {
  std::vector<BlenderCamera> cameras;
  for (const bool orthographic : {false, true})
    for (const float lens : {1.0f, 50.0f, 5000.0f})
      for (const int fit : {0, 1, 2})
        for (const float shift : {0.0f, 0.3f, -10.0f})
          for (const float aspect : {1.0f, 2.0f})
            cameras.push_back({orthographic, lens, lens / 10, 36.0f, 20.0f, fit, shift, 0.5f * shift, 1.0f, aspect});
  return cameras;
}

TEST(Camera, ProjectsAsBlenderAndRaysGoBackThere) {
  std::mt19937 random(31);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  for (const auto& [w, h] : {std::pair{640, 360}, std::pair{300, 500}})
    for (const BlenderCamera& blender : all_cameras()) {
      const GradusCamera desc = make_camera(blender, w, h, kPose);
      const camera::Camera camera(desc, uint32_t(w), uint32_t(h));
      const Projection p = blender_projection(blender, w, h);
      for (int i = 0; i < 20; ++i) {
        const Vec2 film(u(random) * float(w), u(random) * float(h));
        const Ray ray = camera.ray({film, Vec2(0.5f)});
        const Vec3 world = ray.origin + ray.direction * (ray.t_min * 20.0f + 1.0f);
        Vec2 back;
        ASSERT_TRUE(camera.project(world, Moment::Now, &back));
        // A lens of 5 m magnifies the rounding of the world position.
        const double tolerance = blender.lens > 1000.0f ? 0.03 : 0.01;
        EXPECT_NEAR(back.x, film.x, tolerance);
        EXPECT_NEAR(back.y, film.y, tolerance);
        // Blender's projection, computed in double.
        const glm::dvec3 local = glm::dvec3(glm::inverse(glm::dmat4(kPose)) * glm::dvec4(glm::dvec3(world), 1.0));
        const double depth = blender.orthographic ? 1.0 : -local.z;
        EXPECT_NEAR((p.m00 * local.x / depth + p.axis_x + 1) * 0.5 * w, film.x, tolerance);
        EXPECT_NEAR((p.m11 * local.y / depth + p.axis_y + 1) * 0.5 * h, film.y, tolerance);
        EXPECT_NEAR(camera.depth(ray.origin + ray.direction * ray.t_min, ray.time), 0.1f, 1e-5f);
        EXPECT_NEAR(camera.depth(ray.origin + ray.direction * ray.t_max, ray.time), 1000.0f, 0.1f);
      }
      Vec2 film;
      EXPECT_FALSE(camera.project(Vec3(kPose * Vec4(0, 0, 1, 1)), Moment::Now, &film));
    }
}

TEST(Camera, RaysOfAFilmPointMeetOnTheFocalPlane) {
  for (const bool orthographic : {false, true}) {
    BlenderCamera blender;
    blender.orthographic = orthographic;
    GradusCamera desc = make_camera(blender, 640, 360, kPose);
    desc.aperture_radius = 0.3f;
    const camera::Camera camera(desc, 640, 360);
    desc.aperture_radius = 0.0f;
    const camera::Camera pinhole(desc, 640, 360);
    const Vec2 film(500, 70);
    const Ray sharp = pinhole.ray({film});
    const Vec3 focus = sharp.origin + sharp.direction * (4.0f * sharp.t_min / 0.1f);
    gradus::test::Random random(5);
    for (int i = 0; i < 100; ++i) {
      const Ray ray = camera.ray({film, random.get2()});
      const Vec3 to_focus = focus - ray.origin;
      EXPECT_NEAR(glm::length(glm::cross(ray.direction, to_focus)), 0.0f, 1e-5f);
      EXPECT_NEAR(camera.depth(ray.origin + ray.direction * ray.t_min, ray.time), 0.1f, 1e-5f);
    }
  }
}

// Expects a uniform density over the aperture: compares counts of lens positions on a grid with the area of each cell
// inside of the shape.
void expect_uniform_lens(uint32_t blades, float rotation, float ratio) {
  GradusCamera desc = make_camera({}, 100, 100, Mat4(1.0f));
  desc.aperture_radius = 1.0f;
  desc.blades = blades;
  desc.blade_rotation = rotation;
  desc.aperture_ratio = ratio;
  const camera::Camera camera(desc, 100, 100);
  constexpr int kGrid = 40;
  constexpr size_t kSamples = 200000;
  std::vector<double> observed(kGrid * kGrid), expected(kGrid * kGrid);
  const auto cell = [](float v, float extent) { return int((v / extent + 1.0f) * 0.5f * kGrid); };
  gradus::test::Random random(7);
  size_t outside = 0;
  for (size_t i = 0; i < kSamples; ++i) {
    const Vec3 p = camera.ray({Vec2(50.0f), random.get2()}).origin;
    const int x = cell(p.x, 1.001f / ratio), y = cell(p.y, 1.001f);
    if (x < 0 || x >= kGrid || y < 0 || y >= kGrid)
      ++outside;
    else
      observed[size_t(y * kGrid + x)] += 1.0;
  }
  const auto inside = [&](double x, double y) {
    if (blades < 3) return x * x + y * y < 1.0;
    const double half = 3.14159265358979 / blades, angle = std::atan2(y, x) - rotation;
    const double within = std::remainder(angle, 2 * half);
    return std::sqrt(x * x + y * y) * std::cos(within) < std::cos(half);
  };
  constexpr int kSub = 16;
  double sum = 0.0;
  for (int i = 0; i < kGrid * kSub; ++i)
    for (int j = 0; j < kGrid * kSub; ++j) {
      const double x = ((j + 0.5) / (kGrid * kSub) * 2 - 1) * 1.001, y = ((i + 0.5) / (kGrid * kSub) * 2 - 1) * 1.001;
      if (!inside(x, y)) continue;
      expected[size_t(i / kSub * kGrid + j / kSub)] += 1.0;
      sum += 1.0;
    }
  for (double& e : expected) e *= double(kSamples) / sum;
  const auto result = gradus::test::chi_square_counts(observed, expected, kSamples, outside);
  EXPECT_TRUE(result.passed) << result.text;
}

// At each moment, its rays are those of a static camera with the pose and window of that moment.
TEST(Camera, MovesAndZoomsWhileTheShutterIsOpen) {
  for (const bool orthographic : {false, true}) {
    BlenderCamera blender;
    blender.orthographic = orthographic;
    GradusCamera moving = make_camera(blender, 640, 360, kPose);
    std::vector<Mat4> matrices;
    std::vector<float> windows;
    const auto frozen_at = [&](float time) {
      GradusCamera camera = make_camera(blender, 640, 360, translation(Vec3(0.5f * time, -time, 2.0f * time)) * kPose);
      for (float& value : camera.window) value *= 1.0f + time;
      return camera;
    };
    for (const float time : {0.0f, 0.5f, 1.0f}) {
      const GradusCamera key = frozen_at(time);
      matrices.push_back(translation(Vec3(0.5f * time, -time, 2.0f * time)) * kPose);
      windows.insert(windows.end(), key.window, key.window + 4);
    }
    moving.shutter_key_count = 3;
    moving.shutter_matrices = &matrices[0][0][0];
    moving.shutter_windows = windows.data();
    const camera::Camera camera(moving, 640, 360);
    for (const float time : {0.0f, 0.2f, 0.5f, 0.9f, 1.0f}) {
      const Ray ray = camera.ray({Vec2(500, 70), Vec2(0.0f), time}),
                expected = camera::Camera(frozen_at(time), 640, 360).ray({Vec2(500, 70)});
      EXPECT_LT(glm::length(ray.origin - expected.origin), 1e-5f) << time;
      EXPECT_LT(glm::length(ray.direction - expected.direction), 1e-5f) << time;
      EXPECT_EQ(ray.time, time);
    }
  }
}

// Regression: a camera used the first 129 keys, as if the shutter closed there; meshes and instances refuse more.
TEST(Camera, RefusesMoreThanTheMaximumNumberOfShutterKeys) {
  GradusCamera moving = make_camera(BlenderCamera{}, 640, 360, kPose);
  const std::vector<Mat4> matrices(geometry::kMaxShutterKeys + 1, kPose);
  moving.shutter_matrices = &matrices[0][0][0];
  TestScene scene;
  for (const uint32_t count : {2u, geometry::kMaxShutterKeys}) {
    moving.shutter_key_count = count;
    EXPECT_EQ(refusal_of([&] { camera::Camera(moving, 640, 360); }), "");
    EXPECT_EQ(refusal_of([&] { scene.scene.set_camera(moving); }), "");
  }
  const std::string refusal = "camera: 130 shutter keys, at most 129 are possible";
  moving.shutter_key_count = geometry::kMaxShutterKeys + 1;
  EXPECT_EQ(refusal_of([&] { camera::Camera(moving, 640, 360); }), refusal);
  EXPECT_EQ(refusal_of([&] { scene.scene.set_camera(moving); }), refusal);
  moving.shutter_key_count = 1;
  EXPECT_EQ(refusal_of([&] { scene.scene.set_camera(moving); }), "camera: 1 shutter key, at least 2 are needed");
}

TEST(A3_LensSampling, RoundAndPolygonal) {
  expect_uniform_lens(0, 0.0f, 1.0f);
  expect_uniform_lens(3, 0.3f, 1.0f);
  expect_uniform_lens(6, 0.1f, 2.0f);
  expect_uniform_lens(9, -0.7f, 0.5f);
}

}  // namespace
}  // namespace gradus::test::camera_test
