#include "camera/camera_keys.h"

#include "base/error.h"
#include "geometry/matrix_keys.h"

namespace gradus::camera {

namespace {

// Maximum number of values of a shutter curve.
constexpr uint32_t kMaxCurve = 1u << 16;

std::vector<float> copy(const float* data, size_t count) {
  return data != nullptr ? std::vector<float>(data, data + count) : std::vector<float>();
}

const float* pointer(const std::vector<float>& values) { return values.empty() ? nullptr : values.data(); }

}  // namespace

CameraKeys copy_camera_keys(const GradusCamera& camera) {
  const uint32_t count = camera.shutter_key_count;
  geometry::check_shutter_key_count("camera", count);
  if (count > 0 && camera.shutter_matrices == nullptr) throw invalid_argument("camera: shutter_matrices is missing");
  if (camera.shutter_curve_count > kMaxCurve) throw invalid_argument("camera: the shutter curve has too many values");
  return {copy(camera.shutter_curve, camera.shutter_curve_count), copy(camera.shutter_matrices, size_t{16} * count),
          copy(camera.shutter_windows, size_t{4} * count)};
}

void refer_to(const CameraKeys& keys, GradusCamera* camera) {
  camera->shutter_curve = pointer(keys.curve);
  camera->shutter_matrices = pointer(keys.matrices);
  camera->shutter_windows = pointer(keys.windows);
}

}  // namespace gradus::camera
