// Reflectance of an interface under the angle to the (micro)normal.
#pragma once

#include <algorithm>
#include <cmath>

#include "bsdf/closures.h"

namespace gradus::bsdf {

// Unpolarised dielectric reflectance. cosine >= 0 on the side of arrival; eta: IOR of the far side over the near one. 1
// beyond the critical angle. (Born and Wolf §1.5; this form: Walter et al. 2007, eq. 22.)
inline float fresnel_dielectric(float cosine, float eta) {
  const float g2 = eta * eta - 1.0f + cosine * cosine;
  if (!(g2 > 0.0f)) {
    return 1.0f;
  }
  const float g = std::sqrt(g2);
  const float a = (g - cosine) / (g + cosine);
  const float b = (cosine * (g + cosine) - 1.0f) / (cosine * (g - cosine) + 1.0f);
  return std::min(1.0f, 0.5f * a * a * (1.0f + b * b));
}

// At normal incidence.
inline float fresnel_f0(float eta) {
  const float root = (eta - 1.0f) / (eta + 1.0f);
  return root * root;
}

inline float pow5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

// Position between f0 (0) and f90 (1) on the dielectric curve of eta; Schlick's fifth power (1994) where eta is 1.
inline float schlick_position(float cosine, float eta) {
  const float f0 = fresnel_f0(eta);
  if (f0 < 1e-6f) {
    return pow5(std::max(0.0f, 1.0f - cosine));
  }
  return std::clamp((fresnel_dielectric(cosine, eta) - f0) / (1.0f - f0), 0.0f, 1.0f);
}

// Factor b of the term −b·c·(1−c)^6 that pulls Schlick's curve down to f0…1 times `tint` at 82° (Kutz, Hasan, Edmondson
// 2021, "Novel aspects of the Adobe Standard Material", eq. 6).
inline Rgb f82_factor(const Rgb& f0, const Rgb& tint) {
  const float c = 6.0f / 7.0f;
  const float c5 = pow5(c);
  const Rgb schlick = f0 + (Rgb(1.0f) - f0) * c5;
  return schlick * (7.0f / (c5 * c)) * (Rgb(1.0f) - tint);
}

inline Rgb fresnel_f82(float cosine, const Rgb& f0, const Rgb& tint) {
  const float s = std::max(0.0f, 1.0f - cosine);
  const float s5 = pow5(s);
  const Rgb schlick = f0 + (Rgb(1.0f) - f0) * s5;
  return glm::clamp(schlick - f82_factor(f0, tint) * (cosine * s5 * s), 0.0f, 1.0f);
}

// Reflectance of a lobe whose microfacet meets the ray under `cosine`; lobe.ior as after finish().
inline Rgb lobe_fresnel(const Lobe& lobe, float cosine) {
  switch (lobe.fresnel) {
    case FresnelType::None:
      return Rgb(1.0f);
    case FresnelType::Dielectric:
      return Rgb(fresnel_dielectric(cosine, lobe.ior));
    case FresnelType::Schlick:
      return glm::mix(lobe.f0, lobe.f90, schlick_position(cosine, lobe.ior));
    case FresnelType::PrincipledMetal:
      return fresnel_f82(cosine, lobe.f0, lobe.f90);
  }
  return Rgb(1.0f);
}

// Whether light crosses the interface under this angle at all.
inline bool refracts(float cosine, float eta) { return eta * eta - 1.0f + cosine * cosine > 0.0f; }

// Reflected and transmitted share of a lobe that has both sides, or only one (then the other is not drawn at all).
struct FresnelSplit {
  Rgb reflected;
  Rgb transmitted;
};
inline FresnelSplit lobe_fresnel_split(const Lobe& lobe, float cosine) {
  const bool two_sided = lobe.type == LobeType::GgxGlass || lobe.type == LobeType::DiracGlass;
  const bool crosses = refracts(cosine, lobe.ior);
  if (!two_sided && (lobe.type == LobeType::GgxRefraction || lobe.type == LobeType::DiracRefraction)) {
    const Rgb passed = lobe.fresnel == FresnelType::None ? Rgb(1.0f) : Rgb(1.0f) - lobe_fresnel(lobe, cosine);
    return {Rgb(0.0f), crosses ? passed * lobe.transmission_tint : Rgb(0.0f)};
  }
  if (!two_sided) {
    return {lobe_fresnel(lobe, cosine), Rgb(0.0f)};
  }
  // A glass lobe without a Fresnel type is dielectric.
  const Rgb reflected =
      lobe.fresnel == FresnelType::None ? Rgb(fresnel_dielectric(cosine, lobe.ior)) : lobe_fresnel(lobe, cosine);
  return {reflected, crosses ? (Rgb(1.0f) - reflected) * lobe.transmission_tint : Rgb(0.0f)};
}

}  // namespace gradus::bsdf
