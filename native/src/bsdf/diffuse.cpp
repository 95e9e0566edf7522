// Diffuse lobes: Lambert, Oren-Nayar in Fujii's improved form, its energy-conserving extension EON, Disney's diffuse
// lobe with retro-reflection, and the translucent lobe, which is a Lambert lobe on the far side of the surface.
//
// Fujii, "A tiny improvement of Oren-Nayar reflectance model" (2012); Portsmouth, Kutz, Hill, "EON: A practical
// energy-preserving rough diffuse BRDF" (2024), whose equation numbers are given below. Cycles uses Fujii's model up to
// 4.1 and EON from 4.2 on. Disney's lobe (Burley 2015, "Extending the Disney BRDF to a BSDF with integrated subsurface
// scattering", eq. 4) is the base of the Principled BSDF before 4.0.
#include <algorithm>
#include <cmath>

#include "bsdf/fresnel.h"
#include "bsdf/lobe.h"
#include "bsdf/warp.h"

namespace gradus::bsdf {
namespace {

// Returns the coefficient A of Fujii's model times π. The coefficient B is A·roughness.
float fujii_a(float roughness) { return 1.0f / (1.0f + roughness * (0.5f - 2.0f / (3.0f * kPi))); }

// Returns the directional albedo of Fujii's model for a white surface (eq. 12, 13).
float fujii_albedo(float cosine, float roughness) {
  const float a = fujii_a(roughness);
  const float s = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  // (s/c)(1 - s³) loses its digits by cancellation at grazing angles, where it tends to 3c/2.
  const float ratio = cosine < 1e-2f ? 1.5f * cosine : s / cosine * (1.0f - s * s * s);
  const float g = s * (std::acos(std::min(1.0f, cosine)) - s * cosine) + (2.0f / 3.0f) * (ratio - s);
  return a * (1.0f + roughness * kInvPi * g);
}

// Returns the mean of fujii_albedo() over the cosine-weighted hemisphere (eq. 14).
float fujii_mean_albedo(float roughness) {
  return fujii_a(roughness) * (1.0f + roughness * (2.0f / 3.0f - 28.0f / (15.0f * kPi)));
}

// Returns the multiple-scattering term (eq. 20), which the caller multiplies by the surface's colour. That is one
// factor of colour more than published, as in Cycles.
Rgb multiple_scattering(const Lobe& lobe, float cos_o, float cos_i) {
  const float mean = fujii_mean_albedo(lobe.alpha_x);
  const float shape =
      (1.0f - fujii_albedo(cos_o, lobe.alpha_x)) * (1.0f - fujii_albedo(cos_i, lobe.alpha_x)) / (1.0f - mean);
  const Rgb color = glm::clamp(lobe.f0, 0.0f, 1.0f);
  return color * color * (mean * std::max(0.0f, shape)) / (Rgb(1.0f) - color * (1.0f - mean));
}

// Returns a part of Disney's diffuse lobe times π. At grazing angles it is darker than Lambert if smooth, and brighter
// towards the light if rough. The exit part lacks the factor of the point at which light enters.
float disney(DisneyPart part, float roughness, const Vec3& wo, const Vec3& wi) {
  const float fl = pow5(std::clamp(1.0f - wi.z, 0.0f, 1.0f));
  const float fv = pow5(std::clamp(1.0f - wo.z, 0.0f, 1.0f));
  if (part == DisneyPart::Exit) {
    return 1.0f - 0.5f * fl;
  }
  const float retro = roughness * (glm::dot(wo, wi) + 1.0f);
  const float reflected_back = retro * (fl + fv + fl * fv * (retro - 1.0f));
  return part == DisneyPart::RetroReflection ? reflected_back
                                             : (1.0f - 0.5f * fl) * (1.0f - 0.5f * fv) + reflected_back;
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
    return {lobe.weight * (std::max(0.0f, disney(lobe.disney, lobe.alpha_x, wo, wi)) * pdf), pdf};
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

BsdfEval evaluate_translucent(const Lobe& lobe, const Vec3&, const Vec3& wi, uint8_t) {
  if (!(wi.z < 0.0f)) {
    return {};
  }
  const float pdf = -wi.z * kInvPi;
  return {lobe.weight * pdf, pdf};
}

bool sample_translucent(const Lobe&, const Vec3&, float, const Vec2& u, uint8_t, Vec3* wi) {
  *wi = sample_cosine_hemisphere(u);
  wi->z = -wi->z;
  return true;
}

}  // namespace gradus::bsdf
