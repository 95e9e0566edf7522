// Reflection and refraction by microfacets (Walter et al. 2007, eq. 20 and 21), for a distribution of their normals
// such as Ggx or Beckmann. Samples are drawn from the normals that are visible from wo.
//
// As in Cycles, radiance is not scaled by the square of the IOR ratio when it is refracted. The picture of a closed
// glass object is the same, and no single interface amplifies light.
#pragma once

#include "bsdf/fresnel.h"
#include "bsdf/lobe.h"
#include "bsdf/refract.h"

namespace gradus::bsdf {

// Returns G2(wo, wi)/(|wo.z|·|wi.z|).
template <class Distribution>
float masking_of(const Lobe& lobe, const Distribution& normals, const Vec3& wo, const Vec3& wi) {
  return lobe.separable_masking ? normals.masking_over_cosine(wo) * normals.masking_over_cosine(wi)
                                : normals.masking_over_cosines(wo, wi);
}

template <class Distribution>
BsdfEval evaluate_reflection(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(wo.z > 0.0f && wi.z > 0.0f)) {
    return {};
  }
  const Distribution normals{lobe.alpha_x, lobe.alpha_y};
  const Vec3 h = glm::normalize(wo + wi);
  const float density = 0.25f * normals.density(h);
  const float shape = density * masking_of(lobe, normals, wo, wi) * wi.z;
  const Rgb fresnel = lobe_fresnel_split(lobe, std::min(1.0f, glm::dot(wo, h))).reflected;
  const Rgb once = lobe.weight * fresnel * shape;
  return {spreads_bounces(lobe) ? once + spread_bounces(lobe, wo.z, wi.z) : once * lobe.energy,
          density * normals.masking_over_cosine(wo)};
}

template <class Distribution>
bool sample_reflection(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const Vec3 h = Distribution{lobe.alpha_x, lobe.alpha_y}.sample_visible(wo, u);
  *wi = glm::normalize(2.0f * glm::dot(wo, h) * h - wo);
  return wi->z > 0.0f;
}

template <class Distribution>
BsdfEval evaluate_refraction(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
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
  const Distribution normals{lobe.alpha_x, lobe.alpha_y};
  // D times the Jacobian of the half-vector, without the cosines at the macrosurface.
  const float density = normals.density(h) * cos_o * -cos_i * eta * eta / length2;
  const float shape = density * masking_of(lobe, normals, wo, wi) * -wi.z;
  const Rgb fresnel = lobe_fresnel_split(lobe, std::min(1.0f, cos_o)).transmitted;
  return {lobe.weight * lobe.energy * fresnel * shape, density * normals.masking_over_cosine(wo)};
}

template <class Distribution>
bool sample_refraction(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const Vec3 h = Distribution{lobe.alpha_x, lobe.alpha_y}.sample_visible(wo, u);
  return refract_direction(wo, h, lobe.ior, wi) && wi->z < 0.0f;
}

// Returns the probability of choosing reflection at a microfacet of glass.
inline float reflection_probability(const Lobe& lobe, float cosine) {
  const FresnelSplit split = lobe_fresnel_split(lobe, std::min(1.0f, cosine));
  const float reflected = mean_component(split.reflected);
  const float transmitted = mean_component(split.transmitted);
  return reflected > 0.0f ? reflected / (reflected + transmitted) : 0.0f;
}

// Returns the cosine of wo and the half-vector that reflects or refracts wo into wi.
inline float half_cosine(const Lobe& lobe, const Vec3& wo, const Vec3& wi) {
  const Vec3 h = wi.z > 0.0f ? wo + wi : wo + lobe.ior * wi;
  const float length2 = glm::dot(h, h);
  return length2 > 1e-12f ? std::abs(glm::dot(wo, h)) / std::sqrt(length2) : 1.0f;
}

// If both sides of glass belong to one class, the Fresnel term of the sampled normal chooses the side. If reflection
// and transmission are different classes, each side is sampled alone.
template <class Distribution>
BsdfEval evaluate_glass(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides) {
  const bool reflected = wi.z > 0.0f;
  if (!(sides & (reflected ? kReflects : kTransmits))) {
    return {};
  }
  BsdfEval eval = reflected ? evaluate_reflection<Distribution>(lobe, wo, wi, sides)
                            : evaluate_refraction<Distribution>(lobe, wo, wi, sides);
  if (sides == kBothSides && eval.pdf > 0.0f) {
    const float p = reflection_probability(lobe, half_cosine(lobe, wo, wi));
    eval.pdf *= reflected ? p : 1.0f - p;
  }
  return eval;
}

template <class Distribution>
bool sample_glass(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi) {
  if (sides == kReflects) {
    return sample_reflection<Distribution>(lobe, wo, u_side, u, sides, wi);
  }
  if (sides == kTransmits) {
    return sample_refraction<Distribution>(lobe, wo, u_side, u, sides, wi);
  }
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const Vec3 h = Distribution{lobe.alpha_x, lobe.alpha_y}.sample_visible(wo, u);
  const float cosine = glm::dot(wo, h);
  if (u_side < reflection_probability(lobe, cosine)) {
    *wi = glm::normalize(2.0f * cosine * h - wo);
    return wi->z > 0.0f;
  }
  return refract_direction(wo, h, lobe.ior, wi) && wi->z < 0.0f;
}

}  // namespace gradus::bsdf
