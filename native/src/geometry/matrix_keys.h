// The motion of an object or a camera while the shutter is open.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"

namespace gradus::geometry {

// Maximum number of shutter keys of a mesh, an instance or a camera. It is Embree's limit.
inline constexpr uint32_t kMaxShutterKeys = 129;

// Throws Error INVALID_ARGUMENT unless the count is 0 or from 2 to kMaxShutterKeys. The message names `owner`, the
// count and the limit that is violated.
void check_shutter_key_count(const std::string& owner, uint32_t count);

// Matrices at times evenly spaced from the opening of the shutter (time 0) to its closing (time 1). Between two keys a
// matrix is interpolated linearly, as Embree does.
class MatrixKeys {
 public:
  MatrixKeys() = default;
  // Takes from 2 to kMaxShutterKeys keys. If two keys differ by a rotation, the motion between them is a rotation too
  // (slerp of the rotations of their polar decompositions, as in Cycles). Further keys are inserted, so that the linear
  // interpolation between them differs little from the rotation.
  explicit MatrixKeys(const std::vector<glm::dmat4>& keys);

  // Returns the matrix at a shutter time from 0 to 1. There must be keys.
  Mat4 at(float time) const;
  const std::vector<Mat4>& keys() const { return keys_; }
  bool empty() const { return keys_.empty(); }

 private:
  std::vector<Mat4> keys_;
};

// Position of a time among evenly spaced keys.
struct KeyPlace {
  uint32_t before = 0;  // index of the key before the time
  float share = 0.0f;   // weight of the next key, 0 to 1
};
// Finds a shutter time from 0 to 1 among `key_count` keys, at least 2.
KeyPlace key_place(float time, size_t key_count);

// Interpolates between two matrices, 0 <= f <= 1. The rotations of their polar decompositions are interpolated by
// slerp, stretches and translations linearly. If only one matrix is mirrored, all elements are interpolated linearly.
glm::dmat4 interpolate_motion(const glm::dmat4& a, const glm::dmat4& b, double f);

}  // namespace gradus::geometry
