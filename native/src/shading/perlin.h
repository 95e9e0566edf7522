// Gradient noise in 1 to 4 dimensions (Perlin, "Improving Noise", 2002), with the hash and the scale of Blender. The
// values lie in about -1…1.
#pragma once

#include "base/types.h"

namespace gradus::shading {

float signed_noise(float p);
float signed_noise(const Vec2& p);
float signed_noise(const Vec3& p);
float signed_noise(const Vec4& p);

}  // namespace gradus::shading
