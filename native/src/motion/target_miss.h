// Measures by how much a ray misses a target, in the plane through the target across the line of sight. The surface of
// the target need not be hit, and near the target the miss is almost linear in the ray.
#pragma once

#include "base/types.h"
#include "bsdf/shading_frame.h"

namespace gradus::motion {

// A point, or a direction of the sky.
struct Target {
  Vec3 place = Vec3(0.0f);  // position in metres, or unit direction
  bool in_sky = false;
};

class Aim {
 public:
  // origin: approximate origin of the rays to the target.
  Aim(const Target& target, const Vec3& origin) : target_(target) {
    const Vec3 line = target.in_sky ? target.place : target.place - origin;
    const float length = glm::length(line);
    const Vec3 axis = length > 0.0f ? line / length : Vec3(0, 0, 1);
    distance_ = target.in_sky ? 1.0f : length;
    frame_ = bsdf::make_frame(axis, bsdf::perpendicular(axis));
  }

  // Computes the miss across the axis, in metres, or as the tangent of an angle for the sky. Returns false if the ray
  // points away from the target.
  bool miss(const Ray& ray, Vec3* by) const {
    constexpr float kMinCosine = 0.05f;
    const float cosine = glm::dot(ray.direction, axis());
    if (!(cosine > kMinCosine)) return false;
    if (target_.in_sky) {
      *by = ray.direction / cosine - axis();
      return true;
    }
    const Vec3 line = target_.place - ray.origin;
    const float distance = glm::dot(line, axis());
    *by = ray.direction * (distance / cosine) - line;
    return distance > 0.0f;
  }
  // Returns the two coordinates of a miss across the axis.
  Vec2 flat(const Vec3& by) const { return {glm::dot(by, frame_.x), glm::dot(by, frame_.y)}; }
  const Vec3& axis() const { return frame_.z; }
  // Returns the distance of the target, 1 for the sky, relative to which a miss is judged.
  float distance() const { return distance_; }
  // Returns the matrix from coordinates across and along the axis to vectors of space.
  Mat3 axes() const { return {frame_.x, frame_.y, frame_.z}; }

 private:
  Target target_;
  bsdf::Frame3 frame_;
  float distance_;
};

}  // namespace gradus::motion
