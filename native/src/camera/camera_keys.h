// Owning copies of a camera's arrays.
#pragma once

#include <vector>

#include "gradus/gradus.h"

namespace gradus::camera {

struct CameraKeys {
  std::vector<float> curve;
  std::vector<float> matrices;  // 16 for each key
  std::vector<float> windows;   // 4 for each key, or empty
};

// Throws Error INVALID_ARGUMENT.
CameraKeys copy_camera_keys(const GradusCamera& camera);
// Lets the camera's pointers lead to `keys`.
void refer_to(const CameraKeys& keys, GradusCamera* camera);

}  // namespace gradus::camera
