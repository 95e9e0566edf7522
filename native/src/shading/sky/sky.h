// The Sky Texture node. Everything that depends on its settings alone is prepared when a material is compiled. The sky
// types are those of Cycles in Blender 3.4 to 5.0.
#pragma once

#include <optional>
#include <vector>

#include "base/types.h"
#include "gradus/gradus_nodes.h"

namespace gradus::shading {

// Numbers of settings in gradus_nodes.h for PREETHAM and HOSEK_WILKIE, and for all other modes.
inline constexpr uint32_t kAnalyticSkySettings = 5, kSkySettings = 8;
// Returns the table that sky() reads. Settings out of range are clamped; settings that are not finite are replaced by a
// default.
std::vector<float> prepare_sky(uint32_t mode, const float* settings);
// Returns the radiance in a direction. As in Cycles, the direction should be a unit vector and is not normalised.
Rgb sky(uint32_t mode, const float* prepared, const Vec3& direction);

// The disc of a sun. The angle is in radians.
struct SunDisc {
  Vec3 direction = Vec3(0, 0, 1);
  float half_angle = 0.0f;
};
// Returns the sun's disc of a prepared sky, or nothing if it has none.
std::optional<SunDisc> sun_disc(uint32_t mode, const float* prepared);

}  // namespace gradus::shading
