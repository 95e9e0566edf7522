// The GGX distribution of microfacet normals, in the lobe's frame.
//
// The sources are Walter et al. 2007 ("Microfacet Models for Refraction through Rough Surfaces"), Heitz 2014 (masking),
// Heitz 2018 (visible normals), and Dupuy and Benyoub 2023 ("Sampling Visible GGX Normals with Spherical Caps").
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::bsdf {

struct Ggx {
  float alpha_x;
  float alpha_y;

  // Returns the density D of microfacet normals. It uses the tangent components of `h`, because 1 - cos² would lose its
  // digits by cancellation for a small alpha.
  float density(const Vec3& h) const {
    const float x = h.x / alpha_x;
    const float y = h.y / alpha_y;
    const float t = x * x + y * y + h.z * h.z;
    return 1.0f / std::max(kPi * alpha_x * alpha_y * t * t, 1e-30f);
  }
  // Returns |w.z|·(1 + 2Λ(w)), from which the masking terms follow without a division by w.z.
  float masking_root(const Vec3& w) const {
    const float x = alpha_x * w.x;
    const float y = alpha_y * w.y;
    return std::sqrt(x * x + y * y + w.z * w.z);
  }
  // Return G1(wo)/|wo.z| and the height-correlated G2(wo, wi)/(|wo.z|·|wi.z|).
  float masking_over_cosine(const Vec3& wo) const { return 2.0f / (std::abs(wo.z) + masking_root(wo)); }
  float masking_over_cosines(const Vec3& wo, const Vec3& wi) const {
    return 2.0f / std::max(std::abs(wo.z) * masking_root(wi) + std::abs(wi.z) * masking_root(wo), 1e-20f);
  }
  // Samples a normal that is visible from wo (wo.z > 0), with the density D·G1·max(0, wo·h)/wo.z. `u` is in [0, 1)².
  Vec3 sample_visible(const Vec3& wo, const Vec2& u) const {
    const Vec3 stretched = glm::normalize(Vec3(alpha_x * wo.x, alpha_y * wo.y, wo.z));
    const float phi = 2.0f * kPi * u.x;
    const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
    const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const Vec3 h = Vec3(radius * std::cos(phi), radius * std::sin(phi), z) + stretched;
    return glm::normalize(Vec3(alpha_x * h.x, alpha_y * h.y, std::max(h.z, 1e-7f)));
  }
};

// A lobe with a smaller alpha is Dirac. Half-vectors have errors of about 1e-7 in floats, and densities shall have
// three correct digits.
inline constexpr float kSmallestAlpha = 3e-4f;
// An interface whose IOR differs less than this from 1 is ignored, because the half-vector of refraction loses its
// direction.
inline constexpr float kSmallestIorStep = 1e-3f;

}  // namespace gradus::bsdf
