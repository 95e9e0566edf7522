// The way of an object or a camera while the shutter is open.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"

namespace gradus::geometry {

// Most time keys of anything: Embree's limit.
inline constexpr uint32_t kMaxShutterKeys = 129;

// Throws invalid_argument that names `owner`, the count and the maximum, unless the count is 0 or from 2 to
// kMaxShutterKeys.
void check_shutter_key_count(const std::string& owner, uint32_t count);

// Matrices evenly spaced from the opening of the shutter (time 0) to its closing (1), linear in between, as Embree has
// them.
class MatrixKeys {
 public:
  MatrixKeys() = default;
  // At least two, and at most kMaxShutterKeys. Between two keys that are turned against each other the motion is a turn
  // (slerp of the rotations of their polar decompositions, as in Cycles), so keys are put in until straight lines
  // between them differ little from it.
  explicit MatrixKeys(const std::vector<glm::dmat4>& keys);

  Mat4 at(float time) const;
  const std::vector<Mat4>& keys() const { return keys_; }
  bool empty() const { return keys_.empty(); }

 private:
  std::vector<Mat4> keys_;
};

// Place of a time among evenly spaced keys: the key before it, and the share of the next one.
struct KeyPlace {
  uint32_t before = 0;
  float share = 0.0f;
};
KeyPlace key_place(float time, size_t key_count);

// Motion between two matrices, 0 <= f <= 1.
glm::dmat4 interpolate_motion(const glm::dmat4& a, const glm::dmat4& b, double f);

}  // namespace gradus::geometry
