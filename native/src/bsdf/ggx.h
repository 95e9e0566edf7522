// The GGX distribution of microfacet normals, in the lobe's frame.
//
// Walter et al. 2007 ("Microfacet Models for Refraction through Rough Surfaces"), Heitz 2014 (masking), Heitz 2018
// (visible normals), Dupuy and Benyoub 2023 ("Sampling Visible GGX Normals with Spherical Caps").
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::bsdf {

struct Ggx {
  float alpha_x;
  float alpha_y;

  // Density of microfacet normals per projected area. From the tangent components, as 1 - cos² would cancel for small
  // alpha.
  float density(const Vec3& h) const {
    const float x = h.x / alpha_x;
    const float y = h.y / alpha_y;
    const float t = x * x + y * y + h.z * h.z;
    return 1.0f / std::max(kPi * alpha_x * alpha_y * t * t, 1e-30f);
  }
  // |w.z|·(1 + 2Λ(w)): what masking needs, without a division by w.z.
  float masking_root(const Vec3& w) const {
    const float x = alpha_x * w.x;
    const float y = alpha_y * w.y;
    return std::sqrt(x * x + y * y + w.z * w.z);
  }
  // G1(wo)/|wo.z| and G2(wo, wi)/(|wo.z|·|wi.z|), height-correlated.
  float masking_over_cosine(const Vec3& wo) const { return 2.0f / (std::abs(wo.z) + masking_root(wo)); }
  float masking_over_cosines(const Vec3& wo, const Vec3& wi) const {
    return 2.0f / std::max(std::abs(wo.z) * masking_root(wi) + std::abs(wi.z) * masking_root(wo), 1e-20f);
  }
  // A normal as seen from wo (wo.z > 0): density D·G1·max(0, wo·h)/wo.z.
  Vec3 sample_visible(const Vec3& wo, const Vec2& u) const {
    const Vec3 stretched = glm::normalize(Vec3(alpha_x * wo.x, alpha_y * wo.y, wo.z));
    const float phi = 2.0f * kPi * u.x;
    const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
    const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const Vec3 h = Vec3(radius * std::cos(phi), radius * std::sin(phi), z) + stretched;
    return glm::normalize(Vec3(alpha_x * h.x, alpha_y * h.y, std::max(h.z, 1e-7f)));
  }
};

// Below this alpha a lobe is Dirac: half-vectors have errors of about 1e-7 in float, and densities are to keep three
// digits.
inline constexpr float kSmallestAlpha = 3e-4f;
// So near to 1 an interface is no interface: the half-vector of refraction loses its direction.
inline constexpr float kSmallestIorStep = 1e-3f;

}  // namespace gradus::bsdf
