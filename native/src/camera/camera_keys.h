// Owning copies of the arrays to which a camera description points.
#pragma once

#include <vector>

#include "gradus/gradus.h"

namespace gradus::camera {

// The shutter curve and the camera's poses over the shutter interval.
struct CameraKeys {
  std::vector<float> curve;
  std::vector<float> matrices;  // 16 values per key.
  std::vector<float> windows;   // 4 values per key, or empty.
};

// Copies the arrays of a camera description. Throws Error INVALID_ARGUMENT for wrong counts or missing matrices.
CameraKeys copy_camera_keys(const GradusCamera& camera);
// Sets the camera's pointers to the arrays of `keys`, which must outlive their use.
void refer_to(const CameraKeys& keys, GradusCamera* camera);

}  // namespace gradus::camera
