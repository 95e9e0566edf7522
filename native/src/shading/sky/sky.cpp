#include "shading/sky/sky.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shading/op_functions.h"
#include "shading/sky/analytic.h"
#include "shading/sky/dome.h"

namespace gradus::shading {
namespace {

// Minimum angular diameter of the sun's disc in radians, as in Cycles, so that floats resolve it. A smaller sun emits
// the same light.
constexpr float kSmallestSun = 0.0005f;

// Clamps `x`, or returns `otherwise` if `x` is not finite.
float within(float x, float low, float high, float otherwise) {
  return is_finite(x) ? std::clamp(x, low, high) : otherwise;
}

// Normalises the sun's angles. A sun beyond the zenith is on the opposite side of the sky.
void wrap_sun(float elevation, float rotation, DomeSettings* settings) {
  elevation = std::remainder(elevation, 2.0f * kPi);
  if (std::fabs(elevation) > 0.5f * kPi) {
    elevation = std::copysign(kPi, elevation) - elevation;
    rotation += kPi;
  }
  settings->sun_elevation = elevation;
  settings->sun_rotation = std::remainder(rotation, 2.0f * kPi);
}

DomeSettings dome_settings(const float* s) {
  DomeSettings d;
  wrap_sun(within(s[0], -1e6f, 1e6f, 0.0f), within(s[1], -1e6f, 1e6f, 0.0f), &d);
  d.sun_size = s[2] >= 0.0f ? within(s[2], kSmallestSun, kPi, kSmallestSun) : 0.0f;
  d.sun_intensity = within(s[3], 0.0f, 1e6f, 1.0f);
  d.altitude = within(s[4], 0.0f, 1e5f, 0.0f);
  d.air = within(s[5], 0.0f, 1e3f, 1.0f);
  d.aerosols = within(s[6], 0.0f, 1e3f, 1.0f);
  d.ozone = within(s[7], 0.0f, 1e3f, 1.0f);
  return d;
}

std::vector<float> prepare_analytic(uint32_t mode, const float* s) {
  const Vec3 given(s[0], s[1], s[2]);
  const float length = glm::length(given);
  const Vec3 sun = is_finite(length) && length > 0.0f ? given / length : Vec3(0, 0, 1);
  const float turbidity = within(s[3], 1.0f, 10.0f, 2.2f), albedo = within(s[4], 0.0f, 1.0f, 0.3f);
  const AnalyticSky sky =
      mode == GRADUS_SKY_PREETHAM ? prepare_preetham(sun, turbidity) : prepare_hosek_wilkie(sun, turbidity, albedo);
  std::vector<float> prepared(sizeof(sky) / sizeof(float));
  std::memcpy(prepared.data(), &sky, sizeof(sky));
  return prepared;
}

bool is_analytic(uint32_t mode) { return mode == GRADUS_SKY_PREETHAM || mode == GRADUS_SKY_HOSEK_WILKIE; }

}  // namespace

std::vector<float> prepare_sky(uint32_t mode, const float* settings) {
  if (is_analytic(mode)) return prepare_analytic(mode, settings);
  const DomeSettings dome = dome_settings(settings);
  if (mode == GRADUS_SKY_MULTIPLE_SCATTERING) return prepare_multiple_scattering(dome);
  return prepare_single_scattering(dome, mode == GRADUS_SKY_SINGLE_SCATTERING);
}

Rgb sky(uint32_t mode, const float* prepared, const Vec3& direction) {
  if (!is_finite(direction)) return Rgb(0.0f);
  if (!is_analytic(mode)) return dome(prepared, direction);
  AnalyticSky analytic;
  std::memcpy(&analytic, prepared, sizeof(analytic));
  return mode == GRADUS_SKY_PREETHAM ? preetham(analytic, direction) : hosek_wilkie(analytic, direction);
}

void sky_op(const OpArgs& args, Vec4* out) { out[0] = value(sky(args.mode, args.floats, args.v(0))); }

std::optional<SunDisc> sun_disc(uint32_t mode, const float* prepared) {
  if (is_analytic(mode)) return std::nullopt;
  const DomeHeader h = dome_header(prepared);
  if (!(h.half_angle > 0.0f)) return std::nullopt;
  return SunDisc{Vec3(h.sun[0], h.sun[1], h.sun[2]), h.half_angle};
}

}  // namespace gradus::shading
