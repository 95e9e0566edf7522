// The sky of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (SIGGRAPH 1999), appendix A.2, with
// luminance and chromaticity after Perez.
#include <algorithm>
#include <cmath>

#include "image/observer.h"
#include "shading/scalar.h"
#include "shading/sky/analytic.h"
#include "shading/sky/spectrum.h"

namespace gradus::shading {
namespace {

// Factor from kcd/m² of the paper to the node's colours.
constexpr float kLuminance = 0.06f;

float perez(const float* p, float zenith, float sun) {
  const float cos_sun = std::cos(sun);
  return (1.0f + p[0] * std::exp(p[1] / std::cos(zenith))) *
         (1.0f + p[2] * std::exp(p[3] * sun) + p[4] * cos_sun * cos_sun);
}

// A linear function of the turbidity.
struct Line {
  float slope, constant;
};
constexpr Line kPerez[3][5] = {
    {{-0.0193f, -0.2592f}, {-0.0665f, 0.0008f}, {-0.0004f, 0.2125f}, {-0.0641f, -0.8989f}, {-0.0033f, 0.0452f}},
    {{-0.0167f, -0.2608f}, {-0.0950f, 0.0092f}, {-0.0079f, 0.2102f}, {-0.0441f, -1.6537f}, {-0.0109f, 0.0529f}},
    {{0.1787f, -1.4630f}, {-0.3554f, 0.4275f}, {-0.0227f, 5.3251f}, {0.1206f, -2.5771f}, {-0.0670f, 0.3703f}}};
// Coefficients of the chromaticity at the zenith. Rows are powers of the turbidity (2, 1, 0), columns powers of the
// sun's zenith angle (3, 2, 1, 0).
constexpr float kZenith[2][3][4] = {{{0.00166f, -0.00375f, 0.00209f, 0.0f},
                                     {-0.02903f, 0.06377f, -0.03202f, 0.00394f},
                                     {0.11693f, -0.21196f, 0.06052f, 0.25886f}},
                                    {{0.00275f, -0.00610f, 0.00317f, 0.0f},
                                     {-0.04214f, 0.08970f, -0.04153f, 0.00516f},
                                     {0.15346f, -0.26756f, 0.06670f, 0.26688f}}};

float cubic(const float* c, float x) { return ((c[0] * x + c[1]) * x + c[2]) * x + c[3]; }

float zenith_chromaticity(int channel, float turbidity, float angle) {
  const auto& rows = kZenith[channel];
  return (cubic(rows[0], angle) * turbidity + cubic(rows[1], angle)) * turbidity + cubic(rows[2], angle);
}

float zenith_luminance(float turbidity, float angle) {
  const float chi = (4.0f / 9.0f - turbidity / 120.0f) * (kPi - 2.0f * angle);
  return (4.0453f * turbidity - 4.9710f) * std::tan(chi) - 0.2155f * turbidity + 2.4192f;
}

}  // namespace

SkyAngles sky_angles(const AnalyticSky& sky, const Vec3& direction) {
  const float z = std::clamp(direction.z, -1.0f, 1.0f);
  // The direction is moved to the unit sphere at its height z.
  const Vec2 flat = direction.x == 0.0f && direction.y == 0.0f ? Vec2(0, 1) : glm::normalize(Vec2(direction));
  const Vec3 unit(std::sqrt(1.0f - z * z) * flat, z);
  const float cos_sun = glm::dot(unit, Vec3(sky.sun[0], sky.sun[1], sky.sun[2]));
  return {std::min(std::acos(z), 0.5f * kPi - 0.001f), std::acos(std::clamp(cos_sun, -1.0f, 1.0f))};
}

AnalyticSky prepare_preetham(const Vec3& sun, float turbidity) {
  AnalyticSky sky{};
  for (int i = 0; i < 3; ++i) sky.sun[i] = sun[i];
  const float angle = std::acos(std::clamp(sun.z, -1.0f, 1.0f));
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 5; ++k) sky.shape[c][k] = kPerez[c][k].slope * turbidity + kPerez[c][k].constant;
  for (int c = 0; c < 2; ++c) sky.scale[c] = zenith_chromaticity(c, turbidity, angle);
  sky.scale[2] = kLuminance * zenith_luminance(turbidity, angle);
  for (int c = 0; c < 3; ++c) sky.scale[c] /= perez(sky.shape[c], 0.0f, angle);
  return sky;
}

Rgb preetham(const AnalyticSky& sky, const Vec3& direction) {
  const SkyAngles at = sky_angles(sky, direction);
  float v[3];
  for (int c = 0; c < 3; ++c) v[c] = sky.scale[c] * perez(sky.shape[c], at.zenith, at.sun);
  const Vec3 xyz(safe_divide(v[0], v[1]) * v[2], v[2], safe_divide(1.0f - v[0] - v[1], v[1]) * v[2]);
  return glm::max(image::xyz_to_rgb(xyz), Rgb(0.0f));
}

}  // namespace gradus::shading
