// Refraction of directions by Snell's law.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::bsdf {

// Computes the refracted direction *wi at an interface with the unit normal h, where wo·h > 0. `eta` is the IOR of the
// far side over that of the near side. Returns false under total reflection.
inline bool refract_direction(const Vec3& wo, const Vec3& h, float eta, Vec3* wi) {
  const float cosine = glm::dot(wo, h);
  const float inverse = 1.0f / eta;
  const float cos2_t = 1.0f - inverse * inverse * std::max(0.0f, 1.0f - cosine * cosine);
  if (!(cos2_t > 0.0f)) {
    return false;
  }
  *wi = glm::normalize((inverse * cosine - std::sqrt(cos2_t)) * h - inverse * wo);
  return true;
}

}  // namespace gradus::bsdf
