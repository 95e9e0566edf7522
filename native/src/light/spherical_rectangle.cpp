#include "light/spherical_rectangle.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/trigonometry.h"
#include "light/sine.h"

namespace gradus::light {

namespace {

// Returns a complex number whose argument is the solid angle of the rectangle that extends from the foot of the
// perpendicular, which has length z, to (x, y).
std::complex<double> corner(double x, double y, double z) { return {z * std::sqrt(x * x + y * y + z * z), x * y}; }

// Returns a·b by components. This omits the checks of operator* for numbers that are not finite.
std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Returns the solid angle of a rectangle at distance z. The angles of its four corners, atan(xy / (z·sqrt(x²+y²+z²))),
// add up with alternating signs to an angle in (0, 2π), which is a single arctangent of a complex product. Near 0,
// rounding determines the sign. A small negative angle is therefore not wrapped to 2π, and a rectangle that covers
// nearly the whole hemisphere also counts as not usable.
float solid_angle_of(float x0, float x1, float y0, float y1, float z) {
  const std::complex<double> plus = times(corner(x1, y1, z), corner(x0, y0, z)),
                             minus = times(corner(x0, y1, z), corner(x1, y0, z));
  const std::complex<double> all = times(plus, std::conj(minus));
  const double angle = angle_of(all.real(), all.imag());
  constexpr double whole_turn = 6.28318530717958647692;
  return static_cast<float>(angle < -SphericalRectangle::kSmallestSolidAngle ? angle + whole_turn : angle);
}

}  // namespace

SphericalRectangle::SphericalRectangle(const Vec3& centre, const Vec3& axis_x, const Vec3& axis_y, float half_width,
                                       float half_height, const Vec3& from)
    : from_(from), x_(axis_x), y_(axis_y), z_(glm::cross(axis_x, axis_y)) {
  const Vec3 d = centre - from;
  // The rectangle's plane lies at negative z of the local frame.
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
  solid_angle_ = solid_angle_of(x0_, x1_, y0_, y1_, -z0_);
}

Vec3 SphericalRectangle::sample(const Vec2& u) const {
  // These are z components of the unit normals of the planes through the point and one edge each.
  const float n0 = -y0_ / std::sqrt(z0_ * z0_ + y0_ * y0_), n2 = y1_ / std::sqrt(z0_ * z0_ + y1_ * y1_);
  const float n3 = -x0_ / std::sqrt(z0_ * z0_ + x0_ * x0_);
  // The paper's angle is a fraction of the solid angle minus two corner angles, whose cosines are known. The addition
  // theorems avoid inverse functions.
  const float cos_a = -n2 * n3, cos_b = -n3 * n0;
  const float sin_a = precise_sine_of(cos_a), sin_b = precise_sine_of(cos_b);
  const float cos_ab = cos_a * cos_b - sin_a * sin_b, sin_ab = sin_a * cos_b + cos_a * sin_b;
  const SineCosine part = sine_cosine(u.x * solid_angle_);
  const float cos_u = part.cosine * cos_ab + part.sine * sin_ab, sin_u = part.sine * cos_ab - part.cosine * sin_ab;
  const float fu = (cos_u * n0 - n2) / sin_u;
  // The paper's cu is ±1/sqrt(fu² + n0²), and xu = -cu·z0/sqrt(1 - cu²).
  const float xu = std::clamp(std::copysign(z0_, fu) / std::sqrt(std::max(1e-12f, fu * fu + n0 * n0 - 1.0f)), x0_, x1_);
  const float d2 = xu * xu + z0_ * z0_;
  const float h0 = y0_ / std::sqrt(d2 + y0_ * y0_), h1 = y1_ / std::sqrt(d2 + y1_ * y1_);
  const float hv = h0 + u.y * (h1 - h0);
  const float squared_cosine = 1.0f - hv * hv;
  const float yv = squared_cosine > 1e-6f ? std::clamp(hv * std::sqrt(d2) / std::sqrt(squared_cosine), y0_, y1_) : y1_;
  return from_ + x_ * xu + y_ * yv + z_ * z0_;
}

}  // namespace gradus::light
