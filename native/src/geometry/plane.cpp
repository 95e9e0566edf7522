#include "geometry/plane.h"

#include <algorithm>
#include <cmath>

namespace gradus::geometry {

namespace {

// Returns the maximum magnitude of the coordinates.
float largest(const Vec3& v) { return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z))); }

// Bounds of a squared length. Between them, underflow and overflow of float do not affect it.
constexpr float kSmallestSquare = 1e-30f, kLargestSquare = 1e30f;
bool is_safe_square(float square) { return square > kSmallestSquare && square < kLargestSquare; }

// Returns the bound on the rounding error of the plane equation that the next ray computes, as a distance. Embree
// computes the equation from the corners relative to the ray's origin, so that the error grows with the size of the
// triangle. It grows further if the two shorter edges are nearly parallel, because the normal is their cross product.
float plane_error(const Vec3 e[3], float squared_area) {
  const float a = glm::dot(e[0], e[0]), b = glm::dot(e[1], e[1]), c = glm::dot(e[2], e[2]);
  const float low = std::min(a, std::min(b, c)), high = std::max(a, std::max(b, c));
  const float middle = std::max(std::min(a, b), std::min(std::max(a, b), c));
  const float squared_conditioning = low * (middle / squared_area);
  constexpr float worst = 1e8f;  // also used where squares overflow or underflow
  return gamma_bound(8) * std::sqrt(high) *
         std::sqrt(is_finite(squared_conditioning) ? std::clamp(squared_conditioning, 1.0f, worst) : worst);
}

}  // namespace

Vec3 safe_unit(const Vec3& v, const Vec3& fallback) {
  const float square = glm::dot(v, v);
  if (is_safe_square(square)) return v * (1.0f / std::sqrt(square));
  const float scale = largest(v);
  if (!(scale > 0.0f) || !is_finite(scale)) return fallback;
  return glm::normalize(v / scale);
}

Plane plane_of(const std::array<Vec3, 3>& p) {
  const Vec3 e[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const Vec3 cross = glm::cross(e[0], p[2] - p[0]);  // not -e[2]: the sign of zeros affects tangents
  const float square = glm::dot(cross, cross);
  if (is_safe_square(square)) return {cross * (1.0f / std::sqrt(square)), plane_error(e, square)};
  // Squares of coordinates beyond 1e19 overflow, and those of tiny triangles underflow. Scaled edges avoid both.
  const float scale = std::max(largest(e[0]), std::max(largest(e[1]), largest(e[2])));
  const Vec3 normal = scale > 0.0f ? safe_unit(glm::cross(e[0] / scale, -e[2] / scale), Vec3(0, 0, 1)) : Vec3(0, 0, 1);
  return {normal, plane_error(e, square)};
}

}  // namespace gradus::geometry
