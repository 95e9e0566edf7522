#include "light/spherical_triangle.h"

#include <algorithm>
#include <cmath>

#include "light/sine.h"

namespace gradus::light {

namespace {

// Returns 1 − a·b of unit vectors, without cancellation.
float one_minus_dot(const Vec3& a, const Vec3& b) { return 0.5f * glm::dot(a - b, a - b); }

// Returns the unit vector perpendicular to `axis` in the half plane that contains v.
Vec3 side_towards(const Vec3& v, const Vec3& axis) { return glm::normalize(v - axis * glm::dot(v, axis)); }

}  // namespace

// The solid angle is that of Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
SphericalTriangle::SphericalTriangle(const std::array<Vec3, 3>& corners, const Vec3& from)
    : a_(glm::normalize(corners[0] - from)),
      b_(glm::normalize(corners[1] - from)),
      c_(glm::normalize(corners[2] - from)) {
  volume_ = std::fabs(glm::dot(a_, glm::cross(b_, c_)));
  solid_angle_ = 2.0f * std::atan2(volume_, 1.0f + glm::dot(a_, b_) + glm::dot(b_, c_) + glm::dot(c_, a_));
}

// The names are Arvo's. A subtriangle with area A' shares with the triangle the corner a, its angle α and the side c
// towards b. Its third corner c' lies on the side from a to c, and the sampled point lies between b and c'. The
// computation replaces cosines near 1 by 1 − cos, to avoid cancellation.
Vec3 SphericalTriangle::sample(const Vec2& u) const {
  const Vec3 ab = glm::cross(a_, b_), ac = glm::cross(a_, c_);
  const float lengths = std::sqrt(glm::dot(ab, ab) * glm::dot(ac, ac));
  const float sin_alpha = volume_ / lengths, cos_alpha = glm::dot(ab, ac) / lengths;
  const float part = u.x * solid_angle_;
  const float sin_part = std::sin(part), half = std::sin(0.5f * part), one_minus_cos_part = 2.0f * half * half;
  const float s = sin_part * cos_alpha - (1.0f - one_minus_cos_part) * sin_alpha;  // sin(A' − α)
  const float t = (1.0f - one_minus_cos_part) * cos_alpha + sin_part * sin_alpha;  // cos(A' − α)
  const float x = sin_part * sin_alpha - one_minus_cos_part * cos_alpha;           // t − cos α
  const float y = sin_part * cos_alpha + sin_alpha * (one_minus_cos_part - one_minus_dot(a_, b_));
  const float below = (y * s + x * t) * sin_alpha;
  const float q = below != 0.0f ? std::clamp(((y * t - x * s) * cos_alpha - y) / below, -1.0f, 1.0f) : 1.0f;
  const Vec3 end = q * a_ + sine_of(q) * side_towards(c_, a_);
  const float h = u.y * one_minus_dot(end, b_);  // 1 − cos of the angle from b
  return (1.0f - h) * b_ + std::sqrt(std::max(0.0f, h * (2.0f - h))) * side_towards(end, b_);
}

// The intersection is that of Möller and Trumbore 1997.
Vec2 barycentric_towards(const std::array<Vec3, 3>& corners, const Vec3& from, const Vec3& direction) {
  const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], s = from - corners[0];
  const Vec3 p = glm::cross(direction, e2);
  const float determinant = glm::dot(p, e1);
  if (determinant == 0.0f) return Vec2(1.0f / 3.0f);
  Vec2 b(glm::dot(p, s) / determinant, glm::dot(direction, glm::cross(s, e1)) / determinant);
  b = glm::clamp(b, Vec2(0.0f), Vec2(1.0f));
  return b.x + b.y > 1.0f ? b / (b.x + b.y) : b;
}

}  // namespace gradus::light
