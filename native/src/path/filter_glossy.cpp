#include "path/filter_glossy.h"

#include <cmath>

namespace gradus::path {

namespace {

// Upper end of the densities that count as diffuse: 1/π and some rounding.
constexpr float kDiffuseEnd = 0.32f;
// Mean density of a cosine-weighted direction, 2/(3π).
constexpr float kMeanDiffuse = 2.0f / 3.0f * kInvPi;

// Returns the value to which a density is rounded.
float rounded(float pdf) {
  if (!(pdf >= kDiffuseEnd)) {
    return kMeanDiffuse;
  }
  int octave;
  std::frexp(pdf / kDiffuseEnd, &octave);  // 1 for the first octave
  return std::ldexp(kDiffuseEnd * 1.41421356f, octave - 1);
}

float unrounded_blur(float strength, float pdf) {
  return pdf < strength ? FilterGlossy::kMaxBlur * std::sqrt(1.0f - pdf / strength) : 0.0f;
}

}  // namespace

FilterGlossy::FilterGlossy(float strength) : strength_(strength), widest_(unrounded_blur(strength, kMeanDiffuse)) {}

float FilterGlossy::blur_of(float pdf) const { return unrounded_blur(strength_, rounded(pdf)); }

float FilterGlossy::blur_behind(const bsdf::Closures& closures, const Vec3& wo, const Vec3& wi) const {
  if (!(widest_ > 0.0f) || closures.ignores_wo()) {
    return widest_;
  }
  return blur_of(closures.unguided_pdf(wo, wi));
}

}  // namespace gradus::path
