// Skies that are computed by following rays through an atmosphere: a table over the sphere of directions, and the sun's
// disc.
#pragma once

#include <functional>
#include <vector>

#include "base/types.h"

namespace gradus::shading {

struct DomeSettings {
  float sun_elevation = 0.0f;  // -π/2…π/2
  float sun_rotation = 0.0f;   // from +y towards +x
  float sun_size = 0.0f;       // angle across; 0: no disc
  float sun_intensity = 1.0f;
  float altitude = 0.0f;  // m
  float air = 1.0f, aerosols = 1.0f, ozone = 1.0f;
};

// The disc's colour is linear between two elevations.
struct SunColor {
  Rgb low{0.0f}, high{0.0f};
  float low_elevation = 0.0f, high_elevation = 1.0f;
  float horizon = 0.0f;       // elevation below which the ground hides the disc
  bool replaces_sky = false;  // otherwise it comes on top
};

// Both are of floats alone, and are copied into and out of a node's floats.
struct DomeHeader {
  float sun[3];
  float half_angle;  // 0: no disc
  float low[3], high[3];
  float low_elevation, high_elevation;
  float horizon;
  float replaces_sky;
  float rotation;
};

// Rows of elevation, dense at the horizon: row coordinate v in 0…1 is at the elevation ±(2v - 1)²·π/2. Columns of
// azimuth, the sun's in the middle. As large as that of Cycles, whose interpolation it shares.
inline constexpr int kDomeWidth = 512, kDomeHeight = 256;

// Fills the first half of a row: radiance for each azimuth 0 … kDomeWidth/2 - 1. The other half mirrors it.
using DomeRow = std::function<void(int row, Rgb* half)>;
std::vector<float> make_dome(const DomeSettings& settings, const SunColor& sun, const DomeRow& row);

DomeHeader dome_header(const float* prepared);
Rgb dome(const float* prepared, const Vec3& direction);

Vec3 dome_sun_direction(const DomeSettings& settings);

// Of a disc with this angle across.
float disc_solid_angle(float size);
// Elevation below which the ground hides the disc from an altitude in m (Blender 5.0), negative.
float dome_horizon(float altitude);

// single_scattering.cpp. newer: as Blender 5.0 computes it, otherwise as before.
std::vector<float> prepare_single_scattering(const DomeSettings& settings, bool newer);
// multiple_scattering.cpp
std::vector<float> prepare_multiple_scattering(const DomeSettings& settings);

}  // namespace gradus::shading
