// Refraction by GGX microfacets (Walter et al. 2007, eq. 21). Samples are drawn from the visible normals. As in Cycles,
// radiance is not scaled by the square of the IOR ratio. The picture of a closed glass object is the same, and no
// single interface amplifies light.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/lobe.h"
#include "bsdf/refract.h"

namespace gradus::bsdf {

BsdfEval evaluate_ggx_refraction(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(wo.z > 0.0f && wi.z < 0.0f)) {
    return {};
  }
  const float eta = lobe.ior;
  Vec3 h = wo + eta * wi;
  const float length2 = glm::dot(h, h);
  if (!(length2 > 1e-12f)) {
    return {};
  }
  h *= (h.z < 0.0f ? -1.0f : 1.0f) / std::sqrt(length2);
  const float cos_o = glm::dot(wo, h);
  const float cos_i = glm::dot(wi, h);
  if (!(cos_o > 0.0f && cos_i < 0.0f)) {
    return {};
  }
  const Ggx ggx{lobe.alpha_x, lobe.alpha_y};
  // D times the Jacobian of the half-vector, without the cosines at the macrosurface.
  const float density = ggx.density(h) * cos_o * -cos_i * eta * eta / length2;
  const float shape = density * ggx.masking_over_cosines(wo, wi) * -wi.z;
  const Rgb fresnel = lobe_fresnel_split(lobe, std::min(1.0f, cos_o)).transmitted;
  return {lobe.weight * lobe.energy * fresnel * shape, density * ggx.masking_over_cosine(wo)};
}

bool sample_ggx_refraction(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const Vec3 h = Ggx{lobe.alpha_x, lobe.alpha_y}.sample_visible(wo, u);
  return refract_direction(wo, h, lobe.ior, wi) && wi->z < 0.0f;
}

}  // namespace gradus::bsdf
