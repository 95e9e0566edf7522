// Reflection by GGX microfacets (Walter et al. 2007, eq. 20). Samples are drawn from the visible normals.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/lobe.h"

namespace gradus::bsdf {

BsdfEval evaluate_ggx_reflection(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(wo.z > 0.0f && wi.z > 0.0f)) {
    return {};
  }
  const Ggx ggx{lobe.alpha_x, lobe.alpha_y};
  const Vec3 h = glm::normalize(wo + wi);
  const float density = 0.25f * ggx.density(h);
  const float shape = density * ggx.masking_over_cosines(wo, wi) * wi.z;
  const Rgb fresnel = lobe_fresnel_split(lobe, std::min(1.0f, glm::dot(wo, h))).reflected;
  return {lobe.weight * lobe.energy * fresnel * shape, density * ggx.masking_over_cosine(wo)};
}

bool sample_ggx_reflection(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const Vec3 h = Ggx{lobe.alpha_x, lobe.alpha_y}.sample_visible(wo, u);
  *wi = glm::normalize(2.0f * glm::dot(wo, h) * h - wo);
  return wi->z > 0.0f;
}

}  // namespace gradus::bsdf
