// Analytic skies, whose radiance is a formula of two angles and a few parameters for each colour channel.
#pragma once

#include "base/types.h"

namespace gradus::shading {

// The parameters of a sky. The channels are x, y, Y for Preetham and X, Y, Z for Hosek and Wilkie.
struct AnalyticSky {
  float sun[3];       // direction of the sun
  float scale[3];     // factor of each channel
  float shape[3][9];  // parameters of each channel's formula; Preetham uses five
};

// Preetham's sky. The turbidity is in 1…10, and directions are unit vectors.
AnalyticSky prepare_preetham(const Vec3& sun, float turbidity);
Rgb preetham(const AnalyticSky& sky, const Vec3& direction);

// The sky of Hosek and Wilkie. `albedo` is that of the ground, in 0…1.
AnalyticSky prepare_hosek_wilkie(const Vec3& sun, float turbidity, float albedo);
Rgb hosek_wilkie(const AnalyticSky& sky, const Vec3& direction);

// Angles of a direction to the zenith, clamped to above the horizon, and to the sun, in radians.
struct SkyAngles {
  float zenith, sun;
};
SkyAngles sky_angles(const AnalyticSky& sky, const Vec3& direction);

}  // namespace gradus::shading
