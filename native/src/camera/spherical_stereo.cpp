#include "camera/spherical_stereo.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"

namespace gradus::camera {

namespace {

// Returns the eye offset at the sine of an altitude. It can fade out towards the poles, where no side direction is
// defined.
float offset_at(const GradusCamera& c, float sine) {
  if (!(c.pole_merge_to > 0.0f)) return c.eye_offset;
  const float altitude = std::fabs(std::asin(std::clamp(sine, -1.0f, 1.0f)));
  if (altitude > c.pole_merge_to) return 0.0f;
  if (!(altitude > c.pole_merge_from)) return c.eye_offset;
  return c.eye_offset * std::cos((altitude - c.pole_merge_from) / (c.pole_merge_to - c.pole_merge_from) * 0.5f * kPi);
}

// Returns the coordinates (x, y) of the point side·x + direction·y of a ray moved to the eye, at a distance from the
// centre. `direction` is that of the ray before the move.
Vec2 along_ray(const GradusCamera& c, float offset, float distance, bool at_infinity) {
  const float o2 = offset * offset, d2 = distance * distance, focus = c.convergence_distance;
  if (!(focus > 0.0f)) return {at_infinity ? 0.0f : offset, std::sqrt(std::max(at_infinity ? d2 : d2 - o2, 0.0f))};
  const float f2 = focus * focus + o2;
  if (at_infinity) return Vec2(-offset, focus) * (distance / std::sqrt(f2));
  const float t = (o2 + std::sqrt(std::max(o2 * o2 + f2 * (d2 - o2), 0.0f))) / f2;
  return {offset * (1.0f - t), focus * t};
}

}  // namespace

void move_to_eye(const GradusCamera& c, const Vec3& up, Vec3* origin, Vec3* direction) {
  const Vec3 right = glm::cross(*direction, up), side = GRADUS_FAULT(stereo_eyes_exchanged) ? -right : right;
  const float length = glm::length(side);
  if (!(length > 1e-6f)) return;
  const Vec3 offset = side * (offset_at(c, glm::dot(*direction, up)) / length);
  *origin += offset;
  if (c.convergence_distance > 0.0f) *direction = glm::normalize(*direction * c.convergence_distance - offset);
}

bool direction_from_centre(const GradusCamera& c, const Vec3& up, const Vec3& point, bool at_infinity,
                           Vec3* direction) {
  const float distance = glm::length(point), height = glm::dot(point, up);
  if (!(distance > 0.0f)) return false;
  float sine = height / distance;
  Vec2 place;
  for (int i = 0; i < 20; ++i) {  // The offset depends weakly on the altitude, so the solution is iterated.
    place = along_ray(c, offset_at(c, sine), distance, at_infinity);
    if (!(place.y > 0.0f && std::fabs(height) <= place.y * 1.00001f))
      return false;  // The point is nearer to the centre than the eye.
    sine = std::clamp(height / place.y, -1.0f, 1.0f);
  }
  const float cosine = std::sqrt(std::max(1.0f - sine * sine, 0.0f));
  const float forward = place.y * cosine;
  const Vec3 level = point - up * height;
  const float square = forward * forward + place.x * place.x;
  *direction = up * sine;
  if (square > 0.0f) *direction += (level * forward - glm::cross(level, up) * place.x) * (cosine / square);
  return true;
}

}  // namespace gradus::camera
