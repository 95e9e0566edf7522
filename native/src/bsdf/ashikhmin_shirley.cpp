// Reflection by the anisotropic Phong model of Ashikhmin and Shirley 2000 ("An Anisotropic Phong BRDF Model"), without
// its Fresnel term, as in Cycles. The densities of half-vectors and of directions are their equations 6 and 8.
#include <algorithm>
#include <cmath>

#include "base/trigonometry.h"
#include "bsdf/lobe.h"

namespace gradus::bsdf {
namespace {

// Returns the exponent of Phong's lobe for an alpha.
float exponent_of(float alpha) { return std::max(2.0f / (alpha * alpha) - 2.0f, 0.0f); }

}  // namespace

BsdfEval evaluate_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(wo.z > 0.0f && wi.z > 0.0f)) {
    return {};
  }
  const float nx = exponent_of(lobe.alpha_x), ny = exponent_of(lobe.alpha_y);
  const Vec3 h = glm::normalize(wo + wi);
  const float sine2 = h.x * h.x + h.y * h.y;
  // The cosine is computed from the sine, because sharp lobes have exponents of 1e7.
  const float exponent = sine2 > 0.0f ? (nx * h.x * h.x + ny * h.y * h.y) / sine2 : nx;
  const float power = std::exp(0.5f * exponent * std::log1p(-std::min(sine2, 0.9999999f)));
  const float norm = std::sqrt((nx + 1.0f) * (ny + 1.0f)) * (0.125f * kInvPi);
  const float density = norm * power / std::max(glm::dot(wo, h), 1e-6f);
  return {lobe.weight * (density * wi.z / std::max(wo.z, wi.z)), density};
}

bool sample_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const float nx = exponent_of(lobe.alpha_x), ny = exponent_of(lobe.alpha_y);
  const SineCosine turn = sine_cosine(2.0f * kPi * u.x);
  const Vec2 heading = glm::normalize(Vec2(turn.cosine * std::sqrt(ny + 1.0f), turn.sine * std::sqrt(nx + 1.0f)));
  const float exponent = nx * heading.x * heading.x + ny * heading.y * heading.y;
  const float sine2 = -std::expm1(2.0f * std::log1p(-u.y) / (exponent + 1.0f));
  const float sine = std::sqrt(std::max(0.0f, sine2));
  const Vec3 h(sine * heading.x, sine * heading.y, std::sqrt(std::max(0.0f, 1.0f - sine2)));
  const float cosine = glm::dot(wo, h);
  *wi = glm::normalize(2.0f * cosine * h - wo);
  return cosine > 0.0f && wi->z > 0.0f;
}

}  // namespace gradus::bsdf
