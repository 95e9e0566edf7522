// Corrections for shading normals that disagree with the geometric normal.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::bsdf {

// Tilts `normal` towards `geometric_normal` just so far that the mirror direction of wo stays above the geometric
// surface. Otherwise bumps at grazing views would turn black. All vectors are unit vectors, and `normal` and wo lie on
// the side of `geometric_normal`. With N = sinφ·X + cosφ·Z and wo = a·X + c·Z + …, the Z component of the mirror
// direction is a·sin2φ + c·cos2φ = |(a,c)|·cos(2φ − atan2(a, c)).
inline Vec3 keep_reflection_above(const Vec3& normal, const Vec3& geometric_normal, const Vec3& wo) {
  const float c = glm::dot(wo, geometric_normal);
  const float lowest = std::min(0.9f * c, 0.01f);
  const float reflected = 2.0f * glm::dot(normal, wo) * glm::dot(normal, geometric_normal) - c;
  if (reflected >= lowest) {
    return normal;
  }
  const Vec3 across = normal - geometric_normal * glm::dot(normal, geometric_normal);
  const float length2 = glm::dot(across, across);
  if (!(length2 > 1e-12f)) {
    return geometric_normal;
  }
  const Vec3 x = across / std::sqrt(length2);
  const float a = glm::dot(wo, x);
  const float radius = std::sqrt(a * a + c * c);
  const float phi = 0.5f * (std::atan2(a, c) + std::acos(std::clamp(lowest / std::max(radius, 1e-12f), -1.0f, 1.0f)));
  return glm::normalize(std::sin(phi) * x + std::cos(phi) * geometric_normal);
}

// Returns a factor for diffuse reflection towards wi, where a bump has `normal` and the surface `smooth_normal`.
// Without it, bumps that face a light behind the surface would end at a hard edge. The factor is Smith masking with a
// roughness from the tilt of the bump (Estevez, Lecocq, Stein 2019, "A Microfacet-Based Shadowing Function to Solve the
// Bump Terminator Problem", Ray Tracing Gems ch. 12), as in Blender 4.
inline float bump_shadowing(const Vec3& smooth_normal, const Vec3& normal, const Vec3& wi) {
  const float cos_d = std::clamp(std::abs(glm::dot(smooth_normal, normal)), 1e-3f, 1.0f);
  const float cos_i = std::clamp(std::abs(glm::dot(smooth_normal, wi)), 1e-6f, 1.0f);
  const float alpha2 = std::clamp(0.125f * (1.0f - cos_d * cos_d) / (cos_d * cos_d), 0.0f, 1.0f);
  const float tan2_i = (1.0f - cos_i * cos_i) / (cos_i * cos_i);
  return 2.0f / (1.0f + std::sqrt(1.0f + alpha2 * tan2_i));
}

// Returns the factor of bump_shadowing() before Blender 4.5: it falls smoothly from 1 to 0 with the cosine of wi to the
// smooth normal over that to the bump's normal (Chiang, Li, Burley 2019, "Taming the Shadow Terminator").
inline float cosine_bump_shadowing(const Vec3& smooth_normal, const Vec3& normal, const Vec3& wi) {
  const float product = glm::dot(normal, wi) * glm::dot(smooth_normal, normal);
  const float ratio = product != 0.0f ? glm::dot(smooth_normal, wi) / product : 0.0f;
  const float g = std::clamp(ratio, 0.0f, 1.0f);
  return g + g * g - g * g * g;
}

// Returns the factor by which an object's setting Shadow Terminator > Shading Offset changes reflection towards a
// direction with cosine `cos_i` to the normal: the cosine of its angle becomes that of the angle times `frequency`. The
// terminator moves to smaller angles, where the facets of coarse meshes hide less of the smooth surface. This is the
// formula of Cycles, from Appleseed.
inline float terminator_shift(float cos_i, float frequency) {
  if (!(cos_i > 0.0f)) return 0.0f;
  const float angle = std::acos(std::min(cos_i, 1.0f));
  return std::max(std::cos(frequency * angle), 0.0f) / cos_i;
}

}  // namespace gradus::bsdf
