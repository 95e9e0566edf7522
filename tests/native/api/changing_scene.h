// A scene that changes as animations do, through the C API: its mesh has other triangles in every frame, and the number
// of its instances changes.
#pragma once

#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "api/test_scene.h"

namespace gradus::test {

// Sets a fan of 3 to 7 triangles under key 1, with one to three instances.
inline void set_changing(GradusScene scene, int32_t frame) {
  const uint32_t triangles = 3 + uint32_t(frame) % 5, copies = 1 + uint32_t(frame) % 3;
  std::vector<float> positions{0, 0, 0};
  std::vector<int32_t> vertices;
  std::vector<uint32_t> corners;
  for (uint32_t i = 0; i <= triangles; ++i) {
    const float angle = 6.0f * float(i) / float(triangles);
    positions.insert(positions.end(), {std::cos(angle), std::sin(angle), 0.0f});
  }
  for (uint32_t i = 0; i < triangles; ++i) vertices.insert(vertices.end(), {0, int32_t(i) + 1, int32_t(i) + 2});
  for (uint32_t i = 0; i < 3 * triangles; ++i) corners.push_back(i);
  GradusMesh mesh = sized<GradusMesh>();
  mesh.key_count = 1;
  mesh.vertex_count = positions.size() / 3;
  mesh.positions = positions.data();
  mesh.corner_count = vertices.size();
  mesh.corner_vertices = vertices.data();
  mesh.triangle_count = triangles;
  mesh.triangle_corners = corners.data();
  mesh.normal_domain = GRADUS_DOMAIN_FACE;
  for (float& size : mesh.generated_size) size = 1.0f;
  mesh.name = "fan";
  EXPECT_OK(gradus_scene_set_mesh(scene, 1, &mesh));

  const std::vector<uint64_t> meshes(copies, 1);
  std::vector<uint64_t> ids(copies);
  std::vector<float> matrices(size_t{16} * copies);
  for (uint32_t i = 0; i < copies; ++i) {
    ids[i] = uint64_t(frame) % 3 + i;  // one instance appears and one disappears
    set_identity(&matrices[size_t{16} * i]);
    matrices[size_t{16} * i + 14] = -0.3f * float(i);
  }
  GradusInstances instances = sized<GradusInstances>();
  instances.count = copies;
  instances.meshes = meshes.data();
  instances.matrices = matrices.data();
  instances.ids = ids.data();
  EXPECT_OK(gradus_scene_set_instances(scene, &instances));
  EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
}

// Returns settings with L2 as reconstruction: valgrind cannot translate the code of the regression.
inline GradusSettings changing_settings(int32_t frame, uint32_t samples = 2,
                                        uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2) {
  GradusSettings settings = small_render(8, 8, samples);
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = reconstruction;
  settings.frame = frame;
  return settings;
}

// Cancels the render after `microseconds`, or lets it end by itself if that is negative; then releases it.
inline void finish(GradusRender render, int microseconds) {
  if (microseconds >= 0) {
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
    EXPECT_OK(gradus_render_cancel(render));
  }
  const GradusError code = gradus_render_wait(render, -1.0);
  EXPECT_TRUE(code == GRADUS_OK || (code == GRADUS_ERROR_CANCELLED && microseconds >= 0)) << error_text();
  EXPECT_OK(gradus_render_release(render));
}

inline void render_changing(GradusScene scene, int32_t frame) {
  set_changing(scene, frame);
  const GradusSettings settings = changing_settings(frame);
  GradusRender render = 0;
  ASSERT_OK(gradus_render_start(scene, &settings, &render));
  finish(render, -1);
}

// Cancels a render that would take minutes.
inline void cancel_changing(GradusScene scene, int32_t frame) {
  set_changing(scene, frame);
  const GradusSettings settings = changing_settings(frame, 1u << 24);
  GradusRender render = 0;
  ASSERT_OK(gradus_render_start(scene, &settings, &render));
  finish(render, 37 * (frame % 20));
}

// Renders frames 1 to `last` over windows of four frames. Cancels the render number `cancelled`, which ends the
// animation.
inline void animate_changing(GradusDevice device, GradusScene scene, int32_t last, int cancelled = -1,
                             uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2) {
  GradusSequenceSettings range = sized<GradusSequenceSettings>();
  range.first = 1;
  range.last = last;
  range.step = 1;
  range.window_size = 4;
  range.window_overlap = 2;
  GradusSequence sequence = 0;
  ASSERT_OK(gradus_sequence_create(device, &range, &sequence));
  int number = 0;
  const auto is_last = [&](GradusRender render) {
    finish(render, number == cancelled ? 60 * (cancelled % 7) : -1);
    return number++ == cancelled;
  };
  bool ends = false;
  for (int32_t frame = 1; frame <= last && !ends; ++frame) {
    set_changing(scene, frame);
    const GradusSettings settings = changing_settings(frame, 2, reconstruction);
    GradusRender render = 0;
    EXPECT_OK(gradus_sequence_sample(sequence, scene, &settings, &render));
    ends = is_last(render);
  }
  for (int32_t frame = 1; frame <= last && !ends; ++frame) {
    GradusRender render = 0;
    EXPECT_OK(gradus_sequence_deliver(sequence, frame, nullptr, &render));
    ends = is_last(render);
  }
  EXPECT_OK(gradus_sequence_release(sequence));
}

}  // namespace gradus::test
