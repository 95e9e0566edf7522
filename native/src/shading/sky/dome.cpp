#include "shading/sky/dome.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <tbb/parallel_for.h>

namespace gradus::shading {
namespace {

constexpr size_t kHeaderFloats = sizeof(DomeHeader) / sizeof(float);

DomeHeader make_header(const DomeSettings& settings, const SunColor& color) {
  DomeHeader h{};
  const Vec3 sun = dome_sun_direction(settings);
  for (int i = 0; i < 3; ++i) {
    h.sun[i] = sun[i];
    h.low[i] = settings.sun_intensity * color.low[i];
    h.high[i] = settings.sun_intensity * color.high[i];
  }
  h.half_angle = 0.5f * settings.sun_size;
  h.low_elevation = color.low_elevation;
  h.high_elevation = color.high_elevation;
  h.horizon = color.horizon;
  h.replaces_sky = color.replaces_sky ? 1.0f : 0.0f;
  h.rotation = settings.sun_rotation;
  return h;
}

// Returns the angle between two unit vectors. The formula is accurate for small angles and is that of Cycles.
float angle_between(const Vec3& a, const Vec3& b) { return 2.0f * std::atan2(glm::length(a - b), glm::length(a + b)); }

// Returns the radiance of the sun's disc at an angle from its centre and an elevation.
Rgb disc(const DomeHeader& h, float angle, float elevation) {
  const float range = h.high_elevation - h.low_elevation;
  const float t = range > 0.0f ? (elevation - h.low_elevation) / range : 0.5f;
  const float r = angle / h.half_angle;
  const float limb_darkening = 1.0f - 0.6f * (1.0f - std::sqrt(std::max(0.0f, 1.0f - r * r)));
  const Vec3 low(h.low[0], h.low[1], h.low[2]), high(h.high[0], h.high[1], h.high[2]);
  return limb_darkening * (low + t * (high - low));
}

Rgb texel(const float* table, int x, int y) {
  const float* p = table + 3 * (size_t(y) * kDomeWidth + size_t(x));
  return Rgb(p[0], p[1], p[2]);
}

Rgb interpolate(const float* table, float u, float v) {
  const float x = std::clamp(u * float(kDomeWidth) - 0.5f, 0.0f, float(kDomeWidth - 1));
  const float y = std::clamp(v * float(kDomeHeight) - 0.5f, 0.0f, float(kDomeHeight - 1));
  const int x0 = std::min(int(x), kDomeWidth - 2), y0 = std::min(int(y), kDomeHeight - 2);
  const float fx = x - float(x0), fy = y - float(y0);
  const Rgb below = texel(table, x0, y0) * (1.0f - fx) + texel(table, x0 + 1, y0) * fx;
  const Rgb above = texel(table, x0, y0 + 1) * (1.0f - fx) + texel(table, x0 + 1, y0 + 1) * fx;
  return below * (1.0f - fy) + above * fy;
}

}  // namespace

std::vector<float> make_dome(const DomeSettings& settings, const SunColor& sun, const DomeRow& row) {
  std::vector<float> prepared(kHeaderFloats + size_t(3) * kDomeWidth * kDomeHeight);
  const DomeHeader header = make_header(settings, sun);
  std::memcpy(prepared.data(), &header, sizeof(header));
  tbb::parallel_for(0, kDomeHeight, [&](int y) {
    Rgb half[kDomeWidth / 2];
    row(y, half);
    float* out = prepared.data() + kHeaderFloats + size_t(3) * kDomeWidth * size_t(y);
    for (int x = 0; x < kDomeWidth; ++x)
      for (int c = 0; c < 3; ++c) out[3 * x + c] = half[std::min(x, kDomeWidth - 1 - x)][c];
  });
  return prepared;
}

DomeHeader dome_header(const float* prepared) {
  DomeHeader header;
  std::memcpy(&header, prepared, sizeof(header));
  return header;
}

Rgb dome(const float* prepared, const Vec3& direction) {
  const DomeHeader h = dome_header(prepared);
  const float elevation = std::asin(std::clamp(direction.z, -1.0f, 1.0f));
  Rgb sun(0.0f);
  if (h.half_angle > 0.0f && elevation > h.horizon) {
    const float angle = angle_between(direction, Vec3(h.sun[0], h.sun[1], h.sun[2]));
    if (angle < h.half_angle) sun = disc(h, angle, elevation);
    if (angle < h.half_angle && h.replaces_sky != 0.0f) return glm::max(sun, Rgb(0.0f));
  }
  const float turn = (std::atan2(direction.x, direction.y) - h.rotation) * (0.5f * kInvPi) + 0.5f;
  const float l = std::copysign(std::sqrt(std::fabs(elevation) * (2.0f * kInvPi)), elevation);
  const Rgb color = interpolate(prepared + kHeaderFloats, turn - std::floor(turn), 0.5f * l + 0.5f);
  return glm::max(color + sun, Rgb(0.0f));
}

Vec3 dome_sun_direction(const DomeSettings& s) {
  return {std::cos(s.sun_elevation) * std::sin(s.sun_rotation), std::cos(s.sun_elevation) * std::cos(s.sun_rotation),
          std::sin(s.sun_elevation)};
}

float disc_solid_angle(float size) {
  // This is 2π(1 - cos) in a form without cancellation.
  const float s = std::sin(0.25f * size);
  return 4.0f * kPi * s * s;
}

float dome_horizon(float altitude) {
  constexpr float kRadius = 6371e3f;
  return -std::acos(kRadius / (kRadius + std::max(altitude, 0.0f)));
}

}  // namespace gradus::shading
