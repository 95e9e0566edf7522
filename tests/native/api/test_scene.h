// A small scene through the C API: a lit quad seen from the front.
#pragma once

#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "gradus/gradus.h"

namespace gradus::test {

inline std::string error_text() {
  const char* text = "";
  gradus_error(&text);
  return text;
}

#define EXPECT_OK(call) EXPECT_EQ(call, GRADUS_OK) << gradus::test::error_text()
#define ASSERT_OK(call) ASSERT_EQ(call, GRADUS_OK) << gradus::test::error_text()

template <class T>
T sized() {
  T value;
  std::memset(static_cast<void*>(&value), 0, sizeof(value));
  value.struct_size = sizeof(value);
  return value;
}

inline GradusDevice make_device() {
  GradusDeviceSettings settings = sized<GradusDeviceSettings>();
  settings.threads = 2;
  GradusDevice device = 0;
  EXPECT_OK(gradus_device_create(&settings, &device));
  return device;
}

inline void set_identity(float* m) {
  for (int i = 0; i < 16; ++i) m[i] = i % 5 == 0 ? 1.0f : 0.0f;
}

// Sets a quad of side 2 in the plane z = 0 under key 1.
inline GradusError set_quad(GradusScene scene) {
  const float positions[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  const int32_t corners[] = {0, 1, 2, 3};
  const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  GradusMesh mesh = sized<GradusMesh>();
  mesh.key_count = 1;
  mesh.vertex_count = 4;
  mesh.positions = positions;
  mesh.corner_count = 4;
  mesh.corner_vertices = corners;
  mesh.triangle_count = 2;
  mesh.triangle_corners = triangles;
  mesh.normal_domain = GRADUS_DOMAIN_FACE;
  mesh.generated_size[0] = mesh.generated_size[1] = mesh.generated_size[2] = 1.0f;
  mesh.name = "quad";
  return gradus_scene_set_mesh(scene, 1, &mesh);
}

inline GradusError set_instance(GradusScene scene) {
  const uint64_t meshes[] = {1};
  float matrix[16];
  set_identity(matrix);
  GradusInstances instances = sized<GradusInstances>();
  instances.count = 1;
  instances.meshes = meshes;
  instances.matrices = matrix;
  return gradus_scene_set_instances(scene, &instances);
}

inline GradusError set_light(GradusScene scene) {
  GradusLight light = sized<GradusLight>();
  light.type = GRADUS_LIGHT_POINT;
  light.visibility = GRADUS_VISIBLE_ALL;
  set_identity(light.matrix);
  light.matrix[12] = 0.5f;
  light.matrix[14] = 2.0f;
  light.strength[0] = light.strength[1] = light.strength[2] = 10.0f;
  light.radius = 0.3f;
  light.max_bounces = 0xffffffffu;
  return gradus_scene_set_lights(scene, &light, 1);
}

// Sets the camera; x: its distance to the right of the quad's centre.
inline GradusError set_camera_at(GradusScene scene, float x) {
  GradusCamera camera = sized<GradusCamera>();
  for (float* m : {camera.matrix, camera.matrix_previous, camera.matrix_next}) {
    set_identity(m);
    m[12] = x;
    m[14] = 3.0f;
  }
  for (float* w : {camera.window, camera.window_previous, camera.window_next}) {
    w[0] = w[2] = -0.5f;
    w[1] = w[3] = 0.5f;
  }
  camera.clip_start = 0.1f;
  camera.clip_end = 100.0f;
  camera.focus_distance = 3.0f;
  camera.aperture_ratio = 1.0f;
  return gradus_scene_set_camera(scene, &camera);
}

inline GradusError set_camera(GradusScene scene) { return set_camera_at(scene, 0.0f); }

inline void fill_scene(GradusScene scene) {
  EXPECT_OK(set_quad(scene));
  EXPECT_OK(set_instance(scene));
  EXPECT_OK(set_light(scene));
  EXPECT_OK(set_camera(scene));
}

inline GradusScene make_scene(GradusDevice device) {
  GradusScene scene = 0;
  EXPECT_OK(gradus_scene_create(device, &scene));
  fill_scene(scene);
  EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  return scene;
}

// Base class of tests, plain or with a parameter, that need a device and the scene.
template <class Test = ::testing::Test>
class WithScene : public Test {
 protected:
  void SetUp() override {
    device = make_device();
    scene = make_scene(device);
  }
  void TearDown() override {
    EXPECT_OK(gradus_scene_release(scene));
    EXPECT_OK(gradus_device_release(device));
  }
  GradusDevice device = 0;
  GradusScene scene = 0;
};

inline GradusSettings small_render(uint32_t width = 24, uint32_t height = 16, uint32_t samples = 4) {
  GradusSettings s = sized<GradusSettings>();
  EXPECT_OK(gradus_settings_default(&s));
  s.width = width;
  s.height = height;
  s.samples = samples;
  s.noise_threshold = 0.0f;
  return s;
}

}  // namespace gradus::test
