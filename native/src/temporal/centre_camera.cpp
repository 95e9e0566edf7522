#include "temporal/centre_camera.h"

#include <algorithm>

#include <glm/gtc/type_ptr.hpp>

namespace gradus {

Camera centre_camera(const Snapshot& snapshot, uint32_t width, uint32_t height) {
  GradusCamera desc = snapshot.camera;
  const uint32_t count = std::min(desc.shutter_key_count, kMaxShutterKeys);
  if (count < 2) return Camera(desc, width, height).without_lens();
  const float time = snapshot.shutter.time_of_frame();
  std::vector<glm::dmat4> keys;
  for (uint32_t i = 0; i < count; ++i) keys.emplace_back(glm::make_mat4(desc.shutter_matrices + size_t{16} * i));
  const Mat4 pose = MatrixKeys(keys).at(time);
  std::copy_n(glm::value_ptr(pose), 16, desc.matrix);
  if (desc.shutter_windows != nullptr) {
    const KeyPlace place = key_place(time, count);
    const float *before = desc.shutter_windows + size_t{4} * place.before, *after = before + 4;
    for (int k = 0; k < 4; ++k) desc.window[k] = before[k] * (1.0f - place.share) + after[k] * place.share;
  }
  desc.shutter_key_count = 0;
  return Camera(desc, width, height).without_lens();
}

}  // namespace gradus
