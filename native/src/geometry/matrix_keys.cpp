#include "geometry/matrix_keys.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "base/error.h"

namespace gradus::geometry {

namespace {

// Maximum rotation between two keys, in radians. A chord of this angle deviates from its circle by 3e-4 of the radius.
constexpr double kLargestTurn = 0.05;

// A polar decomposition m = rotation · stretch, in which the rotation is the one nearest to m. Source: Higham (1986),
// Newton's iteration for the polar decomposition. The stretch of a mirrored matrix has a negative determinant.
struct Polar {
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dmat3 stretch{1.0};
};

Polar decompose(const glm::dmat3& m) {
  const double sign = glm::determinant(m) < 0.0 ? -1.0 : 1.0;
  glm::dmat3 rotation = m * (sign / std::cbrt(std::fabs(glm::determinant(m))));
  for (int i = 0; i < 40; ++i) {
    const glm::dmat3 next = (rotation + glm::transpose(glm::inverse(rotation))) * 0.5;
    double change = 0.0;
    for (int k = 0; k < 3; ++k) change = std::max(change, glm::length(next[k] - rotation[k]));
    rotation = next;
    if (change < 1e-12) break;
  }
  return {glm::normalize(glm::quat_cast(rotation)), glm::transpose(rotation) * m};
}

// Returns whether exactly one of the matrices is mirrored. No rotation leads from one to the other then.
bool turns_over(const glm::dmat4& a, const glm::dmat4& b) {
  return (glm::determinant(glm::dmat3(a)) < 0.0) != (glm::determinant(glm::dmat3(b)) < 0.0);
}

// Returns the angle between the rotations of two matrices in radians, or 0 if only one of them is mirrored.
double angle_between(const glm::dmat4& a, const glm::dmat4& b) {
  if (turns_over(a, b)) return 0.0;
  const double cosine = std::fabs(glm::dot(decompose(glm::dmat3(a)).rotation, decompose(glm::dmat3(b)).rotation));
  return 2.0 * std::acos(std::min(cosine, 1.0));
}

// Returns into how many equal steps each interval between two keys is divided. At least 1, and no more than Embree's
// maximum number of keys allows.
size_t parts_between(const std::vector<glm::dmat4>& keys) {
  double angle = 0.0;
  for (size_t i = 1; i < keys.size(); ++i) angle = std::max(angle, angle_between(keys[i - 1], keys[i]));
  const auto wanted = size_t(std::max(std::ceil(angle / kLargestTurn - 1e-6), 1.0));
  return std::clamp<size_t>(wanted, 1, (kMaxShutterKeys - 1) / (keys.size() - 1));
}

}  // namespace

void check_shutter_key_count(const std::string& owner, uint32_t count) {
  const std::string found = owner + ": " + std::to_string(count), maximum = std::to_string(kMaxShutterKeys);
  if (count == 1) throw invalid_argument(found + " shutter key, at least 2 are needed");
  if (count > kMaxShutterKeys) throw invalid_argument(found + " shutter keys, at most " + maximum + " are possible");
}

glm::dmat4 interpolate_motion(const glm::dmat4& a, const glm::dmat4& b, double f) {
  const glm::dmat4 straight = a * (1.0 - f) + b * f;
  if (turns_over(a, b)) return straight;
  const Polar p = decompose(glm::dmat3(a)), q = decompose(glm::dmat3(b));
  glm::dmat4 m(glm::mat3_cast(glm::slerp(p.rotation, q.rotation, f)) * (p.stretch * (1.0 - f) + q.stretch * f));
  m[3] = straight[3];
  return m;
}

MatrixKeys::MatrixKeys(const std::vector<glm::dmat4>& keys) {
  const size_t parts = parts_between(keys);
  for (size_t i = 0; i + 1 < keys.size(); ++i) {
    keys_.emplace_back(keys[i]);
    for (size_t k = 1; k < parts; ++k)
      keys_.emplace_back(interpolate_motion(keys[i], keys[i + 1], double(k) / double(parts)));
  }
  keys_.emplace_back(keys.back());
}

KeyPlace key_place(float time, size_t key_count) {
  const float scaled = time * float(key_count - 1);
  const float before = std::clamp(std::floor(scaled), 0.0f, float(key_count - 2));
  return {uint32_t(before), scaled - before};
}

Mat4 MatrixKeys::at(float time) const {
  const KeyPlace place = key_place(time, keys_.size());
  return keys_[place.before] * (1.0f - place.share) + keys_[place.before + 1] * place.share;
}

}  // namespace gradus::geometry
