// The lobe of a rough dielectric interface. If both sides belong to one class, the Fresnel term of the sampled normal
// chooses the side. If reflection and transmission are different classes, each side is sampled alone.
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/lobe.h"
#include "bsdf/refract.h"

namespace gradus::bsdf {
namespace {

// Returns the probability of choosing reflection at a microfacet.
float reflection_probability(const Lobe& lobe, float cosine) {
  const FresnelSplit split = lobe_fresnel_split(lobe, std::min(1.0f, cosine));
  const float reflected = mean_component(split.reflected);
  const float transmitted = mean_component(split.transmitted);
  return reflected > 0.0f ? reflected / (reflected + transmitted) : 0.0f;
}

// Returns the cosine of wo and the half-vector that reflects or refracts wo into wi.
float half_cosine(const Lobe& lobe, const Vec3& wo, const Vec3& wi) {
  const Vec3 h = wi.z > 0.0f ? wo + wi : wo + lobe.ior * wi;
  const float length2 = glm::dot(h, h);
  return length2 > 1e-12f ? std::abs(glm::dot(wo, h)) / std::sqrt(length2) : 1.0f;
}

}  // namespace

BsdfEval evaluate_ggx_glass(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides) {
  const bool reflected = wi.z > 0.0f;
  if (!(sides & (reflected ? kReflects : kTransmits))) {
    return {};
  }
  BsdfEval eval =
      reflected ? evaluate_ggx_reflection(lobe, wo, wi, sides) : evaluate_ggx_refraction(lobe, wo, wi, sides);
  if (sides == kBothSides && eval.pdf > 0.0f) {
    const float p = reflection_probability(lobe, half_cosine(lobe, wo, wi));
    eval.pdf *= reflected ? p : 1.0f - p;
  }
  return eval;
}

bool sample_ggx_glass(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi) {
  if (sides == kReflects) {
    return sample_ggx_reflection(lobe, wo, u_side, u, sides, wi);
  }
  if (sides == kTransmits) {
    return sample_ggx_refraction(lobe, wo, u_side, u, sides, wi);
  }
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const Vec3 h = Ggx{lobe.alpha_x, lobe.alpha_y}.sample_visible(wo, u);
  const float cosine = glm::dot(wo, h);
  if (u_side < reflection_probability(lobe, cosine)) {
    *wi = glm::normalize(2.0f * cosine * h - wo);
    return wi->z > 0.0f;
  }
  return refract_direction(wo, h, lobe.ior, wi) && wi->z < 0.0f;
}

}  // namespace gradus::bsdf
