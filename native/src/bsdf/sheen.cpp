// Sheen: the inverted-Gaussian "Charlie" distribution of Estevez and Kulla 2017 ("Production Friendly Microfacet Sheen BRDF") with
// Neubelt and Pettineo's visibility term (2013), or, for Blender before 4.0, Disney's grazing term (Burley 2012).
#include <array>
#include <cmath>

#include "bsdf/fresnel.h"
#include "bsdf/lobe.h"
#include "bsdf/warp.h"

namespace gradus {
namespace {

float grazing_term(const Vec3& wo, const Vec3& wi) {
  const Vec3 h = glm::normalize(wo + wi);
  return pow5(std::clamp(1.0f - glm::dot(wi, h), 0.0f, 1.0f)) * wi.z;
}

float charlie_term(float roughness, const Vec3& wo, const Vec3& wi) {
  const float inverse = 1.0f / std::clamp(roughness, 0.1f, 1.0f);
  const Vec3 h = glm::normalize(wo + wi);
  const float sine = std::sqrt(std::max(0.0f, 1.0f - h.z * h.z));
  const float density = (2.0f + inverse) * std::pow(sine, inverse) * (0.5f * kInvPi);
  return density * wi.z / (4.0f * (wo.z + wi.z - wo.z * wi.z));
}

float sheen_term(const Lobe& lobe, const Vec3& wo, const Vec3& wi) {
  return lobe.fresnel == FresnelType::Schlick ? grazing_term(wo, wi) : charlie_term(lobe.alpha_x, wo, wi);
}

constexpr int kCosines = 32;
constexpr int kRoughnesses = 12;  // the last row: the grazing term

struct SheenTable {
  std::array<float, kCosines*(kRoughnesses + 1)> values;

  SheenTable() {
    for (int r = 0; r <= kRoughnesses; r++) {
      for (int c = 0; c < kCosines; c++) {
        values[static_cast<size_t>(r * kCosines + c)] = integrate(r, c);
      }
    }
  }
  static float integrate(int r, int c) {
    Lobe lobe;
    lobe.fresnel = r == kRoughnesses ? FresnelType::Schlick : FresnelType::None;
    lobe.alpha_x = 0.1f + 0.9f * static_cast<float>(r) / (kRoughnesses - 1);
    const float x = static_cast<float>(c) / (kCosines - 1);
    const float cosine = std::max(x * x, 1e-4f);
    const Vec3 wo(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
    constexpr int kSteps = 32;
    float sum = 0.0f;
    for (int i = 0; i < kSteps; i++) {
      for (int j = 0; j < kSteps; j++) {
        // Uniform in z and half the azimuths, with z squared towards the horizon where the lobe is.
        const float s = (static_cast<float>(i) + 0.5f) / kSteps;
        const float z = s * s;
        const float phi = kPi * (static_cast<float>(j) + 0.5f) / kSteps;
        const float radius = std::sqrt(1.0f - z * z);
        sum += sheen_term(lobe, wo, Vec3(radius * std::cos(phi), radius * std::sin(phi), z)) * 2.0f * s;
      }
    }
    return sum * 2.0f * kPi / (kSteps * kSteps);
  }
};

// Of the terms as published.
float raw_albedo(const Lobe& lobe, float cosine) {
  static const SheenTable table;
  const float x = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kCosines - 1);
  const int c = std::min(static_cast<int>(x), kCosines - 2);
  const auto row = [&](int r) {
    const size_t k = static_cast<size_t>(r * kCosines + c);
    return table.values[k] + (table.values[k + 1] - table.values[k]) * (x - static_cast<float>(c));
  };
  if (lobe.fresnel == FresnelType::Schlick) {
    return row(kRoughnesses);
  }
  const float y = (std::clamp(lobe.alpha_x, 0.1f, 1.0f) - 0.1f) / 0.9f * (kRoughnesses - 1);
  const int r = std::min(static_cast<int>(y), kRoughnesses - 2);
  return row(r) + (row(r + 1) - row(r)) * (y - static_cast<float>(r));
}

// Bound of an albedo, with a margin for the table.
float excess(float albedo) { return std::max(1.0f, 1.02f * albedo); }

}  // namespace

float sheen_albedo(const Lobe& lobe, float cosine) {
  const float albedo = raw_albedo(lobe, cosine);
  return albedo / excess(albedo);
}

BsdfEval evaluate_sheen(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(wo.z > 0.0f && wi.z > 0.0f)) {
    return {};
  }
  // Charlie makes energy at grazing angles of smooth sheen: bounded from both sides, so that it stays reciprocal.
  const float bound = excess(raw_albedo(lobe, wo.z)) * excess(raw_albedo(lobe, wi.z));
  return {lobe.weight * sheen_term(lobe, wo, wi) / bound, wi.z * kInvPi};
}

bool sample_sheen(const Lobe&, const Vec3&, float, const Vec2& u, uint8_t, Vec3* wi) {
  *wi = sample_cosine_hemisphere(u);
  return true;
}

}  // namespace gradus
