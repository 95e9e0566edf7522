// Sheen lobes. As in Blender 4.0 and later, sheen is a layer of fibres: a linearly transformed cosine (Zeltner, Burley,
// Chiang 2022, "Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines") with the parameters of
// sheen_table.h. Lobes with fresnel Schlick have Disney's grazing term (Burley 2012), as in Blender before 4.0.
#include <algorithm>
#include <array>
#include <cmath>

#include "bsdf/fresnel.h"
#include "bsdf/lobe.h"
#include "bsdf/sheen_table.h"
#include "bsdf/warp.h"

namespace gradus::bsdf {
namespace {

// ---- Disney's grazing term: (1 − ω_i·h)^5 cos θ_i.

float grazing_term(const Vec3& wo, const Vec3& wi) {
  const Vec3 h = glm::normalize(wo + wi);
  return pow5(std::clamp(1.0f - glm::dot(wi, h), 0.0f, 1.0f)) * wi.z;
}

// Albedo of the grazing term, tabulated at the cosines (i/31)².
struct GrazingTable {
  static constexpr int kCosines = 32;
  std::array<float, kCosines> values;

  GrazingTable() {
    for (int i = 0; i < kCosines; i++) {
      const float x = static_cast<float>(i) / (kCosines - 1);
      values[static_cast<size_t>(i)] = integrate(std::max(x * x, 1e-4f));
    }
  }
  static float integrate(float cosine) {
    const Vec3 wo(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
    constexpr int kSteps = 32;
    float sum = 0.0f;
    for (int i = 0; i < kSteps; i++) {
      for (int j = 0; j < kSteps; j++) {
        // The midpoint rule is uniform in √z and covers half of the azimuths, because the integrand is symmetric.
        const float s = (static_cast<float>(i) + 0.5f) / kSteps;
        const float z = s * s;
        const float phi = kPi * (static_cast<float>(j) + 0.5f) / kSteps;
        const float radius = std::sqrt(1.0f - z * z);
        sum += grazing_term(wo, Vec3(radius * std::cos(phi), radius * std::sin(phi), z)) * 2.0f * s;
      }
    }
    return sum * 2.0f * kPi / (kSteps * kSteps);
  }
  float at(float cosine) const {
    const float x = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kCosines - 1);
    const size_t i = static_cast<size_t>(std::min(static_cast<int>(x), kCosines - 2));
    return values[i] + (values[i + 1] - values[i]) * (x - static_cast<float>(i));
  }
};
float grazing_albedo(float cosine) {
  static const GrazingTable table;
  return table.at(cosine);
}

// ---- The layer of fibres: ω' = (s·x + k·z, s·y, z), normalised, has a cosine distribution; the x axis is the
// projection of ω_o.

// Parameters of the fibre lobe: s (scale), k (skew) and the directional albedo.
struct Fibres {
  float scale;
  float skew;
  float albedo;
};

Fibres fibres_at(float roughness, float cosine) {
  const float x = std::clamp(cosine, 0.0f, 1.0f) * (kSheenSize - 1);
  const float y = std::clamp(roughness, 0.0f, 1.0f) * (kSheenSize - 1);
  const int i = std::min(static_cast<int>(x), kSheenSize - 2);
  const int j = std::min(static_cast<int>(y), kSheenSize - 2);
  const float s = x - static_cast<float>(i);
  const float t = y - static_cast<float>(j);
  const auto mix = [&](const float(*table)[kSheenSize]) {
    const float low = table[j][i] + (table[j][i + 1] - table[j][i]) * s;
    const float high = table[j + 1][i] + (table[j + 1][i + 1] - table[j + 1][i]) * s;
    return low + (high - low) * t;
  };
  return {mix(kSheenScale), mix(kSheenSkew), mix(kSheenAlbedo)};
}

// Returns the unit vector along the projection of ω_o onto the surface.
Vec2 heading(const Vec3& wo) {
  const float length2 = wo.x * wo.x + wo.y * wo.y;
  return length2 > 1e-12f ? Vec2(wo.x, wo.y) / std::sqrt(length2) : Vec2(1.0f, 0.0f);
}

// Returns the density in solid angle of wi, given wo.
float fibre_density(const Fibres& fibres, const Vec3& wo, const Vec3& wi) {
  const Vec2 axis = heading(wo);
  const float x = fibres.scale * (wi.x * axis.x + wi.y * axis.y) + fibres.skew * wi.z;
  const float y = fibres.scale * (wi.y * axis.x - wi.x * axis.y);
  const float ratio = fibres.scale / (x * x + y * y + wi.z * wi.z);
  return wi.z * ratio * ratio * kInvPi;
}

}  // namespace

float sheen_albedo(const Lobe& lobe, float cosine) {
  return lobe.fresnel == FresnelType::Schlick ? grazing_albedo(cosine) : fibres_at(lobe.alpha_x, cosine).albedo;
}

BsdfEval evaluate_sheen(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  // Where a bump faces away from wo, fibres look as at grazing angles, as in Cycles.
  const bool grazing = lobe.fresnel == FresnelType::Schlick;
  if (!(wi.z > 0.0f) || (grazing && !(wo.z > 0.0f))) {
    return {};
  }
  if (grazing) {
    return {lobe.weight * grazing_term(wo, wi), wi.z * kInvPi};
  }
  const Fibres fibres = fibres_at(lobe.alpha_x, wo.z);
  const float density = fibre_density(fibres, wo, wi);
  return {lobe.weight * fibres.albedo * density, density};
}

bool sample_sheen(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  const Vec3 w = sample_cosine_hemisphere(u);
  if (lobe.fresnel == FresnelType::Schlick) {
    *wi = w;
    return true;
  }
  const Fibres fibres = fibres_at(lobe.alpha_x, wo.z);
  const Vec2 axis = heading(wo);
  const float x = (w.x - fibres.skew * w.z) / fibres.scale;
  const float y = w.y / fibres.scale;
  *wi = glm::normalize(Vec3(x * axis.x - y * axis.y, x * axis.y + y * axis.x, w.z));
  return wi->z > 0.0f;
}

}  // namespace gradus::bsdf
