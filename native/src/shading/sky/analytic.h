// Skies whose radiance is a formula: two angles and a handful of parameters for each colour channel.
#pragma once

#include "base/types.h"

namespace gradus::shading {

struct AnalyticSky {
  float sun[3];       // direction
  float scale[3];     // of the channels: x, y, Y or X, Y, Z
  float shape[3][9];  // their parameters; Preetham has five
};

AnalyticSky prepare_preetham(const Vec3& sun, float turbidity);
Rgb preetham(const AnalyticSky& sky, const Vec3& direction);

// albedo: of the ground, 0…1.
AnalyticSky prepare_hosek_wilkie(const Vec3& sun, float turbidity, float albedo);
Rgb hosek_wilkie(const AnalyticSky& sky, const Vec3& direction);

// Angles of a direction: from the zenith, kept above the horizon, and from the sun.
struct SkyAngles {
  float zenith, sun;
};
SkyAngles sky_angles(const AnalyticSky& sky, const Vec3& direction);

}  // namespace gradus::shading
