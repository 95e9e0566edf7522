// Reflectance of an interface as a function of the angle to its normal or microfacet normal.
#pragma once

#include <algorithm>
#include <cmath>

#include "bsdf/closures.h"

namespace gradus::bsdf {

// Returns the dielectric reflectance of unpolarised light, which is 1 beyond the critical angle. `cosine` >= 0 is on
// the side of arrival, and `eta` is the IOR of the far side over that of the near side (Born and Wolf §1.5, in the form
// of Walter et al. 2007, eq. 22).
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

// Returns the dielectric reflectance at normal incidence.
inline float fresnel_f0(float eta) {
  const float root = (eta - 1.0f) / (eta + 1.0f);
  return root * root;
}

inline float pow5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

// Returns the dielectric curve of `eta` scaled to 0 at normal and 1 at grazing incidence. If `eta` is 1 it returns
// Schlick's fifth power (1994).
inline float schlick_position(float cosine, float eta) {
  const float f0 = fresnel_f0(eta);
  if (f0 < 1e-6f) {
    return pow5(std::max(0.0f, 1.0f - cosine));
  }
  return std::clamp((fresnel_dielectric(cosine, eta) - f0) / (1.0f - f0), 0.0f, 1.0f);
}

// Returns the factor b of the term −b·c·(1−c)^6, by which Schlick's curve from f0 to 1 is multiplied by `tint` at 82°
// (Kutz, Hasan, Edmondson 2021, "Novel aspects of the Adobe Standard Material", eq. 6).
inline Rgb f82_factor(const Rgb& f0, const Rgb& tint) {
  const float c = 6.0f / 7.0f;
  const float c5 = pow5(c);
  const Rgb schlick = f0 + (Rgb(1.0f) - f0) * c5;
  return schlick * (7.0f / (c5 * c)) * (Rgb(1.0f) - tint);
}

// Returns the reflectance of the F82 model: Schlick's curve from f0 to 1 with `tint` at 82°.
inline Rgb fresnel_f82(float cosine, const Rgb& f0, const Rgb& tint) {
  const float s = std::max(0.0f, 1.0f - cosine);
  const float s5 = pow5(s);
  const Rgb schlick = f0 + (Rgb(1.0f) - f0) * s5;
  return glm::clamp(schlick - f82_factor(f0, tint) * (cosine * s5 * s), 0.0f, 1.0f);
}

// Returns the reflectance of a conductor with the refractive index n + ik of each channel, for unpolarised light from
// the vacuum (Born and Wolf §14.4.1, in real numbers).
inline Rgb fresnel_conductor(float cosine, const Rgb& n, const Rgb& k) {
  const float cos2 = cosine * cosine, sin2 = 1.0f - cos2;
  const Rgb difference = n * n - k * k - sin2;
  const Rgb length = glm::sqrt(difference * difference + 4.0f * n * n * k * k);
  const Rgb twice = glm::sqrt(2.0f * glm::max(length + difference, 0.0f)) * cosine;
  const Rgb perpendicular = (length + cos2 - twice) / (length + cos2 + twice);
  const Rgb along = length * cos2 + sin2 * sin2, across = twice * sin2;
  return 0.5f * perpendicular * (1.0f + (along - across) / (along + across));
}

// Returns an approximation of fresnel_conductor() for refractive indices much larger than 1 in absolute value, which
// Cycles has before Blender 5.0 (Born and Wolf §14.4.1).
inline Rgb fresnel_conductor_approximately(float cosine, const Rgb& n, const Rgb& k) {
  const Rgb square = n * n + k * k, twice = 2.0f * cosine * n;
  const float cos2 = cosine * cosine;
  const Rgb parallel = (square * cos2 - twice + 1.0f) / (square * cos2 + twice + 1.0f);
  const Rgb perpendicular = (square - twice + cos2) / glm::max(square + twice + cos2, Rgb(1e-30f));
  return 0.5f * (parallel + perpendicular);
}

// The F82 model that agrees with a conductor at 0° and 82°. Its albedo and its mean have closed forms.
struct F82Fit {
  Rgb f0, tint;
};
inline F82Fit fit_conductor(const Lobe& lobe) {
  const auto fresnel =
      lobe.fresnel == FresnelType::ApproximateConductor ? fresnel_conductor_approximately : fresnel_conductor;
  const Rgb f0 = fresnel(1.0f, lobe.f0, lobe.f90);
  const Rgb schlick = f0 + (Rgb(1.0f) - f0) * pow5(6.0f / 7.0f);
  return {f0, fresnel(1.0f / 7.0f, lobe.f0, lobe.f90) / schlick};
}

// Returns the Fresnel term of a finished lobe with a thin film.
Rgb fresnel_film(const Lobe& lobe, float cosine);

// Returns the Fresnel term of a finished lobe, where `cosine` is that of the ray and the microfacet normal.
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
    case FresnelType::Conductor:
      return fresnel_conductor(cosine, lobe.f0, lobe.f90);
    case FresnelType::ApproximateConductor:
      return fresnel_conductor_approximately(cosine, lobe.f0, lobe.f90);
    case FresnelType::FilmDielectric:
    case FresnelType::FilmMetal:
    case FresnelType::FilmConductor:
      return fresnel_film(lobe, cosine);
  }
  return Rgb(1.0f);
}

// Returns whether light crosses the interface, that is, whether there is no total reflection.
inline bool refracts(float cosine, float eta) { return eta * eta - 1.0f + cosine * cosine > 0.0f; }

// Reflected and transmitted share of light at a microfacet. A lobe with one side has 0 for the other.
struct FresnelSplit {
  Rgb reflected;
  Rgb transmitted;
};
inline FresnelSplit lobe_fresnel_split(const Lobe& lobe, float cosine) {
  const uint8_t sides = sides_of(lobe.type);
  const bool crosses = refracts(cosine, lobe.ior);
  if (sides == kTransmits) {
    const Rgb passed = lobe.fresnel == FresnelType::None ? Rgb(1.0f) : Rgb(1.0f) - lobe_fresnel(lobe, cosine);
    return {Rgb(0.0f), crosses ? passed * lobe.transmission_tint : Rgb(0.0f)};
  }
  if (sides == kReflects) {
    return {lobe_fresnel(lobe, cosine), Rgb(0.0f)};
  }
  // A glass lobe without a Fresnel type is dielectric.
  const Rgb reflected =
      lobe.fresnel == FresnelType::None ? Rgb(fresnel_dielectric(cosine, lobe.ior)) : lobe_fresnel(lobe, cosine);
  return {reflected, crosses ? (Rgb(1.0f) - reflected) * lobe.transmission_tint : Rgb(0.0f)};
}

}  // namespace gradus::bsdf
