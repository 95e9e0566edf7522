// Skies that are simulated by rays through an atmosphere. They are stored as a table over the sphere of directions,
// plus the disc of the sun.
#pragma once

#include <functional>
#include <vector>

#include "base/types.h"

namespace gradus::shading {

// Settings of a simulated sky. Angles are in radians.
struct DomeSettings {
  float sun_elevation = 0.0f;  // in -π/2…π/2
  float sun_rotation = 0.0f;   // from +y towards +x
  float sun_size = 0.0f;       // angular diameter; 0 for no disc
  float sun_intensity = 1.0f;
  float altitude = 0.0f;  // in metres
  float air = 1.0f, aerosols = 1.0f, ozone = 1.0f;
};

// The colour of the sun's disc, which is linear in the elevation between two values.
struct SunColor {
  Rgb low{0.0f}, high{0.0f};
  float low_elevation = 0.0f, high_elevation = 1.0f;
  float horizon = 0.0f;       // elevation below which the ground hides the disc
  bool replaces_sky = false;  // the disc replaces the sky's radiance instead of being added to it
};

// The parameters of the disc, which precede the table. All are floats, because they are stored in the floats of a node.
struct DomeHeader {
  float sun[3];
  float half_angle;  // 0 for no disc
  float low[3], high[3];
  float low_elevation, high_elevation;
  float horizon;
  float replaces_sky;
  float rotation;
};

// Size of the table. Rows are elevations, dense at the horizon: the row coordinate v in 0…1 is at the elevation
// ±(2v - 1)²·π/2. Columns are azimuths, with the sun in the middle. Size and interpolation are those of Cycles.
inline constexpr int kDomeWidth = 512, kDomeHeight = 256;

// Writes the radiance of the first half of a row, columns 0 … kDomeWidth/2 - 1. The other half is its mirror image.
using DomeRow = std::function<void(int row, Rgb* half)>;
// Computes the header and the table, in parallel over the rows.
std::vector<float> make_dome(const DomeSettings& settings, const SunColor& sun, const DomeRow& row);

// Return the header, and the radiance in a direction, of a prepared sky.
DomeHeader dome_header(const float* prepared);
Rgb dome(const float* prepared, const Vec3& direction);

Vec3 dome_sun_direction(const DomeSettings& settings);

// Returns the solid angle of a disc with the angular diameter `size`.
float disc_solid_angle(float size);
// Returns the negative elevation below which the ground hides the disc from an altitude in metres (Blender 5.0).
float dome_horizon(float altitude);

// Prepares the single-scattering sky, as in Blender 5.0 if `newer`, else as in earlier versions.
std::vector<float> prepare_single_scattering(const DomeSettings& settings, bool newer);
// Prepares the multiple-scattering sky of Blender 5.0.
std::vector<float> prepare_multiple_scattering(const DomeSettings& settings);

}  // namespace gradus::shading
