// D5 and D6 for the geometry: direct light on a small scene, at other scales and far from the origin.
#include <gtest/gtest.h>

#include "camera/camera.h"
#include "light/light_sampling.h"
#include "scene_fixture.h"
#include "support/chi_square.h"

namespace gradus::test::scale_test {
namespace {

Soup floor_soup() {
  Soup soup;
  soup.triangle({-5, -5, 0}, {5, -5, 0}, {5, 5, 0});
  soup.triangle({-5, -5, 0}, {5, 5, 0}, {-5, 5, 0});
  return soup;
}

GradusCamera look_down(const Mat4& to_world, float scale) {
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  const Mat4 pose = to_world * translation(Vec3(0, 0, 6 * scale));
  for (float* m : {camera.matrix, camera.matrix_previous, camera.matrix_next})
    std::copy(&pose[0][0], &pose[0][0] + 16, m);
  for (float* w : {camera.window, camera.window_previous, camera.window_next}) {
    const float window[4] = {-0.4f, 0.4f, -0.4f, 0.4f};
    std::copy(window, window + 4, w);
  }
  camera.clip_start = 0.01f * scale;
  camera.clip_end = 1000.0f * scale;
  return camera;
}

// Returns the irradiance seen from above, with shadows, by blocks of 8×8 pixels.
std::vector<double> render(float scale, const Vec3& shift, bool instanced) {
  const Mat4 place = translation(shift);
  TestScene scene;
  scene.mesh(1, floor_soup());
  scene.mesh(2, sphere(Vec3(0.0f), 1.0f, instanced ? 100 : 30, instanced ? 200 : 60));
  const Mat4 sized = scaling(Vec3(scale));
  scene.instance(1, place * sized);
  scene.instance(2, place * translation(Vec3(0.5f, 0, 1.2f) * scale) * sized);
  scene.instance(2, place * translation(Vec3(-1.5f, -1, 0.5f) * scale) * scaling(Vec3(0.5f * scale)));
  GradusLight light = make_light(GRADUS_LIGHT_RECTANGLE, place * translation(Vec3(1, 1, 4) * scale), Rgb(1.0f));
  light.size[0] = light.size[1] = scale;
  scene.lights({light});
  scene.scene.set_camera(look_down(place, scale));
  const auto snapshot = scene.commit();
  const camera::Camera camera(snapshot->camera, 64, 64);
  gradus::test::Random random(3);
  std::vector<double> blocks(64);
  for (int i = 0; i < 64 * 64 * 16; ++i) {
    const int x = i % 64, y = i / 64 % 64;
    const Vec2 jitter = random.get2(), u = random.get2();
    const float choice = random.get();
    geometry::Hit hit;
    if (!snapshot->intersect(camera.ray({Vec2(x, y) + jitter, Vec2(0.5f)}), GRADUS_VISIBLE_CAMERA, &hit)) continue;
    const geometry::SurfacePoint point = snapshot->surface_point(hit);
    const light::Receiver receiver{point.position, point.geometric_normal, false};
    light::LightEvaluation view;
    light::LightPoint light_point;
    light::sample_light_point(*snapshot, receiver, choice, u, &light_point, &view);
    const float cosine = glm::dot(view.direction, receiver.normal);
    if (light_point.kind == light::LightKind::None || cosine <= 0.0f || view.pdf <= 0.0f) continue;
    if (snapshot->occluded(
            light::ray_to_light(geometry::offset_origin(point, view.direction), point, light_point, view)))
      continue;
    blocks[size_t(y / 8 * 8 + x / 8)] += double(view.radiance.x * cosine / view.pdf) / (64 * 16);
  }
  return blocks;
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, int blocks_off) {
  double sum_a = 0.0, sum_b = 0.0;
  int off = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    sum_a += a[i];
    sum_b += b[i];
    off += std::fabs(a[i] - b[i]) > 0.03 * std::max(a[i], 1e-3);
  }
  EXPECT_GT(sum_a, 1.0);
  EXPECT_NEAR(sum_b / sum_a, 1.0, 0.01);
  EXPECT_LE(off, blocks_off);
}

TEST(D5_Scale, DirectLightIsTheSame) {
  for (const bool instanced : {false, true}) {
    const std::vector<double> reference = render(1.0f, Vec3(0.0f), instanced);
    for (const float scale : {1e-4f, 1e-2f, 1e2f, 1e4f})
      expect_same(reference, render(scale, Vec3(0.0f), instanced), 0);
  }
}

TEST(D6_FarAway, DirectLightIsTheSame) {
  for (const bool instanced : {false, true}) {
    const std::vector<double> reference = render(1.0f, Vec3(0.0f), instanced);
    // Matrices are floats: at 1e5, objects and lights lie on a grid of 8 mm, which moves the edges of shadows.
    expect_same(reference, render(1.0f, Vec3(1e5f, -1e5f, 1e5f), instanced), 6);
    for (const double block : render(1.0f, Vec3(1e7f, 1e7f, -1e7f), instanced)) EXPECT_TRUE(std::isfinite(block));
  }
}

}  // namespace
}  // namespace gradus::test::scale_test
