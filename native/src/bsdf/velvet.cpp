// Velvet: microfacets whose normals lie near the surface's plane, which is brightest at grazing angles (Ashikhmin,
// Premoze and Shirley 2000, "A Microfacet-Based BRDF Generator", section 5.1). As in Cycles the distribution is not
// normalised, and the masking is that of V-shaped grooves.
#include <algorithm>
#include <cmath>

#include "base/trigonometry.h"
#include "bsdf/lobe.h"

namespace gradus::bsdf {

BsdfEval evaluate_velvet(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(wo.z > 0.0f && wi.z > 0.0f)) {
    return {};
  }
  constexpr float kUniform = 0.5f * kInvPi;
  const Vec3 h = glm::normalize(wo + wi);
  const float cosine = glm::dot(wo, h);
  const float sine2 = h.x * h.x + h.y * h.y;
  if (!(sine2 > 1e-6f && cosine > 1e-5f)) {
    return {Rgb(0.0f), kUniform};
  }
  const float invariant = 1.0f / (lobe.alpha_x * lobe.alpha_x);
  const float density = std::exp(-h.z * h.z / sine2 * invariant) * invariant * kInvPi / (sine2 * sine2);
  const float masking = std::min(1.0f, 2.0f * h.z * std::min(wo.z, wi.z) / cosine);
  return {lobe.weight * (0.25f * density * masking / wo.z), kUniform};
}

// Samples the hemisphere uniformly, because the light at grazing angles has no factor of the cosine.
bool sample_velvet(const Lobe&, const Vec3&, float, const Vec2& u, uint8_t, Vec3* wi) {
  const float radius = std::sqrt(std::max(0.0f, 1.0f - u.x * u.x));
  const SineCosine phi = sine_cosine(2.0f * kPi * u.y);
  *wi = Vec3(radius * phi.cosine, radius * phi.sine, u.x);
  return wi->z > 0.0f;
}

}  // namespace gradus::bsdf
