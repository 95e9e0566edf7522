// Lambert; Oren-Nayar in Fujii's improved form, and its energy-conserving extension EON; Disney's diffuse with
// retro-reflection.
//
// Fujii, "A tiny improvement of Oren-Nayar reflectance model" (2012); Portsmouth, Kutz, Hill, "EON: A practical
// energy-preserving rough diffuse BRDF" (2024), whose equation numbers are given below. Cycles uses the first up to 4.1
// and the second from 4.2 on. Disney's (Burley 2015, "Extending the Disney BRDF to a BSDF with integrated subsurface
// scattering", eq. 4) is the base of Principled before 4.0.
#include <algorithm>
#include <cmath>

#include "bsdf/fresnel.h"
#include "bsdf/lobe.h"
#include "bsdf/warp.h"

namespace gradus::bsdf {
namespace {

// Coefficients A and B = A·roughness of Fujii's model, times π.
float fujii_a(float roughness) { return 1.0f / (1.0f + roughness * (0.5f - 2.0f / (3.0f * kPi))); }

// Directional albedo of Fujii's model with white colour (eq. 12, 13).
float fujii_albedo(float cosine, float roughness) {
  const float a = fujii_a(roughness);
  const float s = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  // (s/c)(1 - s³) cancels badly at grazing angles, where it tends to 3c/2.
  const float ratio = cosine < 1e-2f ? 1.5f * cosine : s / cosine * (1.0f - s * s * s);
  const float g = s * (std::acos(std::min(1.0f, cosine)) - s * cosine) + (2.0f / 3.0f) * (ratio - s);
  return a * (1.0f + roughness * kInvPi * g);
}

// Mean albedo over the cosine hemisphere (eq. 14).
float fujii_mean_albedo(float roughness) {
  return fujii_a(roughness) * (1.0f + roughness * (2.0f / 3.0f - 28.0f / (15.0f * kPi)));
}

// What bounces between the grooves (eq. 20), over the surface's colour. One factor of colour more than published, as in
// Cycles: its result is multiplied by the colour once again.
Rgb multiple_scattering(const Lobe& lobe, float cos_o, float cos_i) {
  const float mean = fujii_mean_albedo(lobe.alpha_x);
  const float shape =
      (1.0f - fujii_albedo(cos_o, lobe.alpha_x)) * (1.0f - fujii_albedo(cos_i, lobe.alpha_x)) / (1.0f - mean);
  const Rgb color = glm::clamp(lobe.f0, 0.0f, 1.0f);
  return color * color * (mean * std::max(0.0f, shape)) / (Rgb(1.0f) - color * (1.0f - mean));
}

// Times π. At grazing angles darker than Lambert where smooth, brighter towards the light where rough.
float disney(float roughness, const Vec3& wo, const Vec3& wi) {
  const float fl = pow5(std::clamp(1.0f - wi.z, 0.0f, 1.0f));
  const float fv = pow5(std::clamp(1.0f - wo.z, 0.0f, 1.0f));
  const float retro = roughness * (glm::dot(wo, wi) + 1.0f);
  return (1.0f - 0.5f * fl) * (1.0f - 0.5f * fv) + retro * (fl + fv + fl * fv * (retro - 1.0f));
}

}  // namespace

BsdfEval evaluate_diffuse(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (is_lambert(lobe)) {
    return evaluate_lambert(lobe, wi.z);
  }
  if (!(wi.z > 0.0f)) {
    return {};
  }
  const float pdf = wi.z * kInvPi;
  if (lobe.fresnel == FresnelType::Schlick) {
    return {lobe.weight * (std::max(0.0f, disney(lobe.alpha_x, wo, wi)) * pdf), pdf};
  }
  const float cos_o = std::max(0.0f, wo.z);
  float t = glm::dot(wo, wi) - wi.z * cos_o;
  if (t > 0.0f) {
    t /= std::max(std::max(wi.z, cos_o), 1e-6f);
  }
  Rgb f = Rgb(std::max(0.0f, fujii_a(lobe.alpha_x) * (1.0f + lobe.alpha_x * t)));
  if (lobe.multiscatter) {
    f += multiple_scattering(lobe, cos_o, wi.z);
  }
  return {lobe.weight * f * pdf, pdf};
}

bool sample_diffuse(const Lobe&, const Vec3&, float, const Vec2& u, uint8_t, Vec3* wi) {
  *wi = sample_cosine_hemisphere(u);
  return true;
}

}  // namespace gradus::bsdf
