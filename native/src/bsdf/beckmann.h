// Beckmann's distribution of microfacet normals, in the lobe's frame: the slopes of the microfacets are Gaussian.
//
// The sources are Walter et al. 2007 ("Microfacet Models for Refraction through Rough Surfaces"), Heitz 2014 (masking)
// and Heitz and d'Eon 2014 ("Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals").
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::bsdf {

inline constexpr float kInvSqrtPi = 0.564189584f;

// Returns the inverse of the error function for x in (-1, 1) (Giles 2010, "Approximating the erfinv function").
inline float inverse_erf(float x) {
  const auto polynomial = [](float w, std::initializer_list<float> coefficients) {
    float sum = 0.0f;
    for (const float c : coefficients) sum = sum * w + c;
    return sum;
  };
  const float w = -std::log(std::max((1.0f - x) * (1.0f + x), 1e-12f));
  const float factor =
      w < 5.0f
          ? polynomial(w - 2.5f, {2.81022636e-08f, 3.43273939e-07f, -3.5233877e-06f, -4.39150654e-06f, 0.00021858087f,
                                  -0.00125372503f, -0.00417768164f, 0.246640727f, 1.50140941f})
          : polynomial(std::sqrt(w) - 3.0f, {-0.000200214257f, 0.000100950558f, 0.00134934322f, -0.00367342844f,
                                             0.00573950773f, -0.0076224613f, 0.00943887047f, 1.00167406f, 2.83297682f});
  return factor * x;
}

struct Beckmann {
  float alpha_x;
  float alpha_y;

  // Returns the density D of microfacet normals.
  float density(const Vec3& h) const {
    const float z2 = std::max(h.z * h.z, 1e-12f);
    const float x = h.x / alpha_x;
    const float y = h.y / alpha_y;
    return std::exp(-(x * x + y * y) / z2) / (kPi * alpha_x * alpha_y * z2 * z2);
  }
  // Returns |w.z|·(1 + Λ(w)), the projected area of the microfacets that are visible from w.
  float visible_area(const Vec3& w) const {
    const float x = alpha_x * w.x;
    const float y = alpha_y * w.y;
    return area(std::abs(w.z), std::sqrt(x * x + y * y));
  }
  // Return G1(wo)/|wo.z| and the height-correlated G2(wo, wi)/(|wo.z|·|wi.z|).
  float masking_over_cosine(const Vec3& wo) const { return 1.0f / std::max(visible_area(wo), 1e-20f); }
  float masking_over_cosines(const Vec3& wo, const Vec3& wi) const {
    const float o = std::abs(wo.z), i = std::abs(wi.z);
    return 1.0f / std::max(visible_area(wo) * i + visible_area(wi) * o - o * i, 1e-20f);
  }
  // Samples a normal that is visible from wo (wo.z > 0), with the density D·G1·max(0, wo·h)/wo.z. `u` is in [0, 1)².
  Vec3 sample_visible(const Vec3& wo, const Vec2& u) const {
    const Vec3 stretched = glm::normalize(Vec3(alpha_x * wo.x, alpha_y * wo.y, wo.z));
    const float sine = std::sqrt(stretched.x * stretched.x + stretched.y * stretched.y);
    const Vec2 heading = sine > 1e-6f ? Vec2(stretched.x, stretched.y) / sine : Vec2(1.0f, 0.0f);
    // The slope towards wo, and that across it.
    const float along = sample_slope(stretched.z, sine, u.x);
    const float across = inverse_erf(2.0f * u.y - 1.0f);
    const float x = alpha_x * (heading.x * along - heading.y * across);
    const float y = alpha_y * (heading.y * along + heading.x * across);
    return glm::normalize(Vec3(-x, -y, 1.0f));
  }

 private:
  // Returns ∫(cosine − s·sine)·exp(−s²)/√π ds over the slopes s below cosine/sine.
  static float area(float cosine, float sine) {
    const float a = cosine / std::max(sine, 1e-20f);
    return 0.5f * (cosine * (1.0f + std::erf(a)) + sine * kInvSqrtPi * std::exp(-std::min(a * a, 80.0f)));
  }
  // Returns the slope s up to which the integral of area() is the share u of the whole, by Newton's method with
  // bisection where that leaves the interval.
  static float sample_slope(float cosine, float sine, float u) {
    constexpr float kLargestSlope = 4.2f;  // a larger one has a probability below 1e-8
    float low = -kLargestSlope, high = std::min(kLargestSlope, cosine / std::max(sine, 1e-6f));
    const float target = u * area(cosine, sine);
    float slope = std::clamp(inverse_erf(2.0f * u - 1.0f), low, high);
    for (int i = 0; i < 20; i++) {
      const float gaussian = kInvSqrtPi * std::exp(-slope * slope);
      const float excess = 0.5f * (cosine * (1.0f + std::erf(slope)) + sine * gaussian) - target;
      if (std::abs(excess) < 1e-7f) break;
      (excess > 0.0f ? high : low) = slope;
      const float next = slope - excess / std::max((cosine - slope * sine) * gaussian, 1e-12f);
      slope = next > low && next < high ? next : 0.5f * (low + high);
    }
    return slope;
  }
};

}  // namespace gradus::bsdf
