// By how much a ray misses what it is to show. In a plane through the target, across the line of sight: the target's
// own surface need not be hit, and near the target the miss is as linear in the ray as can be.
#pragma once

#include "base/types.h"
#include "bsdf/shading_frame.h"

namespace gradus::motion {

// A point, or a direction of the sky.
struct Target {
  Vec3 place = Vec3(0.0f);
  bool in_sky = false;
};

class Aim {
 public:
  // origin: about where rays to the target come from.
  Aim(const Target& target, const Vec3& origin) : target_(target) {
    const Vec3 line = target.in_sky ? target.place : target.place - origin;
    const float length = glm::length(line);
    const Vec3 axis = length > 0.0f ? line / length : Vec3(0, 0, 1);
    distance_ = target.in_sky ? 1.0f : length;
    frame_ = bsdf::make_frame(axis, bsdf::perpendicular(axis));
  }

  // Across the axis, in metres; for the sky in tangents of angles. False: the ray goes away from the target.
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
  // Coordinates of a miss.
  Vec2 flat(const Vec3& by) const { return {glm::dot(by, frame_.x), glm::dot(by, frame_.y)}; }
  const Vec3& axis() const { return frame_.z; }
  // To the target; what a miss is small against.
  float distance() const { return distance_; }
  // From coordinates, with the axis' own as the third.
  Mat3 axes() const { return {frame_.x, frame_.y, frame_.z}; }

 private:
  Target target_;
  bsdf::Frame3 frame_;
  float distance_;
};

}  // namespace gradus::motion
