#include "scene/spherical_rectangle.h"

#include <algorithm>
#include <cmath>

namespace gradus {

namespace {

float safe_acos(float c) { return std::acos(std::clamp(c, -1.0f, 1.0f)); }

}  // namespace

SphericalRectangle::SphericalRectangle(const Vec3& centre, const Vec3& axis_x, const Vec3& axis_y, float half_width, float half_height,
                                       const Vec3& from)
    : from_(from), x_(axis_x), y_(axis_y), z_(glm::cross(axis_x, axis_y)) {
  const Vec3 d = centre - from;
  // The plane lies at negative z of the local frame.
  z0_ = glm::dot(d, z_);
  if (z0_ > 0.0f) {
    z_ = -z_;
    z0_ = -z0_;
  }
  x0_ = glm::dot(d, x_) - half_width;
  x1_ = glm::dot(d, x_) + half_width;
  y0_ = glm::dot(d, y_) - half_height;
  y1_ = glm::dot(d, y_) + half_height;
  if (!(z0_ < 0.0f)) return;
  // z components of the unit normals of the four planes through the point and an edge; the others follow from them.
  const float n0 = -y0_ / std::sqrt(z0_ * z0_ + y0_ * y0_), n2 = y1_ / std::sqrt(z0_ * z0_ + y1_ * y1_);
  const float n1 = x1_ / std::sqrt(z0_ * z0_ + x1_ * x1_), n3 = -x0_ / std::sqrt(z0_ * z0_ + x0_ * x0_);
  const float g0 = safe_acos(-n0 * n1), g1 = safe_acos(-n1 * n2), g2 = safe_acos(-n2 * n3), g3 = safe_acos(-n3 * n0);
  b0_ = n0;
  b1_ = n2;
  k_ = 2.0f * kPi - g2 - g3;
  solid_angle_ = g0 + g1 - k_;
}

Vec3 SphericalRectangle::sample(const Vec2& u) const {
  const float au = u.x * solid_angle_ + k_;
  const float fu = (std::cos(au) * b0_ - b1_) / std::sin(au);
  const float cu = std::clamp(std::copysign(1.0f, fu) / std::sqrt(fu * fu + b0_ * b0_), -1.0f, 1.0f);
  const float xu = std::clamp(-(cu * z0_) / std::sqrt(std::max(1e-12f, 1.0f - cu * cu)), x0_, x1_);
  const float d2 = xu * xu + z0_ * z0_;
  const float h0 = y0_ / std::sqrt(d2 + y0_ * y0_), h1 = y1_ / std::sqrt(d2 + y1_ * y1_);
  const float hv = h0 + u.y * (h1 - h0);
  const float rest = 1.0f - hv * hv;
  const float yv = rest > 1e-6f ? std::clamp(hv * std::sqrt(d2) / std::sqrt(rest), y0_, y1_) : y1_;
  return from_ + x_ * xu + y_ * yv + z_ * z0_;
}

}  // namespace gradus
