#include "shading/perlin.h"

#include <cmath>

#include "shading/lattice_hash.h"

namespace gradus::shading {
namespace {

float smootherstep(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }
float mix(float a, float b, float t) { return a + (b - a) * t; }
float flip(float x, uint32_t condition) { return condition ? -x : x; }

float gradient(uint32_t hash, float x) {
  const float g = 1.0f + static_cast<float>(hash & 7u);
  return flip(g, hash & 8u) * x;
}
float gradient(uint32_t hash, float x, float y) {
  const bool first = (hash & 7u) < 4u;
  const float u = first ? x : y, v = 2.0f * (first ? y : x);
  return flip(u, hash & 1u) + flip(v, hash & 2u);
}
float gradient(uint32_t hash, float x, float y, float z, float w) {
  const uint32_t h = hash & 31u;
  const float u = h < 24u ? x : y, v = h < 16u ? y : z, s = h < 8u ? z : w;
  return flip(u, h & 1u) + flip(v, h & 2u) + flip(s, h & 4u);
}

// A lattice cell along one axis, and the position within it in 0…1.
struct Cell {
  uint32_t index;
  float offset;
};

Cell cell(float x) {
  const float lower = std::floor(x);
  return {static_cast<uint32_t>(static_cast<int32_t>(lower)), x - lower};
}

// Wraps coordinates to a range where floats have fractions, and replaces infinity and NaN by 0.
float wrapped(float x) {
  if (!is_finite(x)) return 0.0f;
  return std::fabs(x) < 1e5f ? x : std::fmod(x, 1e5f) + (std::fabs(x) >= 1e6f ? 0.5f : 0.0f);
}

// The corners of a cell in eight lanes. Bit 0 of the lane number is the step along x, bit 1 along y, and bit 2 along z.
constexpr Lanes kStepX = {0, 1, 0, 1, 0, 1, 0, 1}, kStepY = {0, 0, 1, 1, 0, 0, 1, 1}, kStepZ = {0, 0, 0, 0, 1, 1, 1, 1};
constexpr FloatLanes kOffsetX = {0, 1, 0, 1, 0, 1, 0, 1}, kOffsetY = {0, 0, 1, 1, 0, 0, 1, 1},
                     kOffsetZ = {0, 0, 0, 0, 1, 1, 1, 1};

// Changes the sign where bit 0 of `condition` is set.
FloatLanes flip_lanes(FloatLanes v, Lanes condition) { return (FloatLanes)((Lanes)v ^ (condition << 31)); }

float perlin3(const Cell& x, const Cell& y, const Cell& z) {
  const Lanes h = lattice_hash(kStepX + x.index, kStepY + y.index, kStepZ + z.index) & 15u;
  const FloatLanes dx = x.offset - kOffsetX, dy = y.offset - kOffsetY, dz = z.offset - kOffsetZ;
  const FloatLanes u = h < 8u ? dx : dy;
  const FloatLanes t = (h == 12u) | (h == 14u) ? dx : dz;
  const FloatLanes v = h < 4u ? dy : t;
  const FloatLanes g = flip_lanes(u, h & 1u) + flip_lanes(v, (h >> 1) & 1u);
  const float fx = smootherstep(x.offset), fy = smootherstep(y.offset);
  const float low = mix(mix(g[0], g[1], fx), mix(g[2], g[3], fx), fy);
  const float high = mix(mix(g[4], g[5], fx), mix(g[6], g[7], fx), fy);
  return mix(low, high, smootherstep(z.offset));
}

float perlin4(const Cell& x, const Cell& y, const Cell& z, const Cell& w) {
  const float u = smootherstep(x.offset), v = smootherstep(y.offset), s = smootherstep(z.offset);
  float volumes[2];
  for (uint32_t l = 0; l < 2; l++) {
    float planes[2];
    for (uint32_t k = 0; k < 2; k++) {
      const uint32_t iz = z.index + k, iw = w.index + l;
      const float dz = z.offset - static_cast<float>(k), dw = w.offset - static_cast<float>(l);
      float rows[2];
      for (uint32_t j = 0; j < 2; j++) {
        const uint32_t iy = y.index + j;
        const float dy = y.offset - static_cast<float>(j);
        rows[j] = mix(gradient(lattice_hash(x.index, iy, iz, iw), x.offset, dy, dz, dw),
                      gradient(lattice_hash(x.index + 1, iy, iz, iw), x.offset - 1.0f, dy, dz, dw), u);
      }
      planes[k] = mix(rows[0], rows[1], v);
    }
    volumes[l] = mix(planes[0], planes[1], s);
  }
  return mix(volumes[0], volumes[1], smootherstep(w.offset));
}

}  // namespace

// The factors of the four functions below scale the range to about -1…1.
float signed_noise(float p) {
  const Cell x = cell(wrapped(p));
  return 0.25f * mix(gradient(lattice_hash(x.index), x.offset), gradient(lattice_hash(x.index + 1), x.offset - 1.0f),
                     smootherstep(x.offset));
}

float signed_noise(const Vec2& p) {
  const Cell x = cell(wrapped(p.x)), y = cell(wrapped(p.y));
  const float u = smootherstep(x.offset);
  float rows[2];
  for (uint32_t j = 0; j < 2; j++) {
    const float dy = y.offset - static_cast<float>(j);
    rows[j] = mix(gradient(lattice_hash(x.index, y.index + j), x.offset, dy),
                  gradient(lattice_hash(x.index + 1, y.index + j), x.offset - 1.0f, dy), u);
  }
  return 0.6616f * mix(rows[0], rows[1], smootherstep(y.offset));
}

float signed_noise(const Vec3& p) {
  return 0.982f * perlin3(cell(wrapped(p.x)), cell(wrapped(p.y)), cell(wrapped(p.z)));
}

float signed_noise(const Vec4& p) {
  return 0.8344f * perlin4(cell(wrapped(p.x)), cell(wrapped(p.y)), cell(wrapped(p.z)), cell(wrapped(p.w)));
}

}  // namespace gradus::shading
