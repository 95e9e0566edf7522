// The Sky Texture node. What depends on its settings alone is prepared once, when a material is compiled; the pictures
// are those of the sky types of Cycles, in Blender 3.4 to 5.0.
#pragma once

#include <optional>
#include <vector>

#include "base/types.h"
#include "gradus/gradus_nodes.h"

namespace gradus::shading {

// How many settings gradus_nodes.h lists for PREETHAM and HOSEK_WILKIE, and for the rest.
inline constexpr uint32_t kAnalyticSkySettings = 5, kSkySettings = 8;
// The table that sky() reads. Settings that are out of range or not finite become the nearest that are not.
std::vector<float> prepare_sky(uint32_t mode, const float* settings);
// Radiance along a direction, whose length is not looked at but for where the node takes it for one (as Cycles).
Rgb sky(uint32_t mode, const float* prepared, const Vec3& direction);

// A sun that a sky draws.
struct SunDisc {
  Vec3 direction = Vec3(0, 0, 1);
  float half_angle = 0.0f;
};
std::optional<SunDisc> sun_disc(uint32_t mode, const float* prepared);

}  // namespace gradus::shading
