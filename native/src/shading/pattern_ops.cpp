// The Checker, Gradient, Wave, Magic and Brick Texture nodes.
#include "shading/fractal.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Moves integer coordinates off the borders of cells, because surfaces often have such coordinates.
Vec3 off_border(const Vec3& p) { return (p + 0.000001f) * 0.999999f; }

float gradient_value(uint32_t mode, const Vec3& p) {
  switch (mode) {
    case GRADUS_GRADIENT_QUADRATIC: {
      const float r = std::max(p.x, 0.0f);
      return r * r;
    }
    case GRADUS_GRADIENT_EASING: {
      const float r = saturate(p.x);
      return r * r * (3.0f - 2.0f * r);
    }
    case GRADUS_GRADIENT_DIAGONAL:
      return (p.x + p.y) * 0.5f;
    case GRADUS_GRADIENT_RADIAL:
      return std::atan2(p.y, p.x) * (0.5f * kInvPi) + 0.5f;
    case GRADUS_GRADIENT_QUADRATIC_SPHERE:
    case GRADUS_GRADIENT_SPHERICAL: {
      const float r = std::max(0.999999f - glm::length(p), 0.0f);
      return mode == GRADUS_GRADIENT_SPHERICAL ? r : r * r;
    }
    default:
      return p.x;
  }
}

float wave_phase(uint32_t type, uint32_t direction, Vec3 p) {
  if (type == 0) return direction < 3 ? p[static_cast<int>(direction)] * 20.0f : (p.x + p.y + p.z) * 10.0f;
  if (direction < 3) p[static_cast<int>(direction)] = 0.0f;
  return glm::length(p) * 20.0f;
}

float wave_profile(uint32_t profile, float phase) {
  if (profile == 0) return 0.5f + 0.5f * std::sin(phase - 0.5f * kPi);
  const float turns = phase * (0.5f * kInvPi);
  return profile == 1 ? fraction(turns) : std::fabs(turns - std::floor(turns + 0.5f)) * 2.0f;
}

// Returns the hash of a brick in 0…1. The arithmetic is modulo 2^32.
float brick_tint(uint32_t n) {
  n = (n + 1013u) & 0x7fffffffu;
  n = (n >> 13) ^ n;
  const uint32_t bits = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
  return 0.5f * (static_cast<float>(bits) / 1073741824.0f);
}

bool every(int row, int frequency) { return frequency != 0 && row % frequency == 0; }

}  // namespace

void checker_op(const OpArgs& args, Vec4* out) {
  const Vec3 p = glm::abs(glm::floor(off_border(args.v(0) * args.f(3))));
  const auto odd = [](float x) { return 0.5f * x != std::floor(0.5f * x); };  // for integers
  const bool first = (odd(p.x) == odd(p.y)) == odd(p.z);
  out[0] = args.in[first ? 1 : 2];
  out[1] = splat(first ? 1.0f : 0.0f);
}

void gradient_op(const OpArgs& args, Vec4* out) { out[0] = splat(saturate(gradient_value(args.mode, args.v(0)))); }

void wave_op(const OpArgs& args, Vec4* out) {
  const Vec3 p = off_border(args.v(0) * args.f(1));
  float phase = wave_phase(args.mode & 1, (args.mode >> 1) & 3, p) + args.f(6);
  if (args.f(2) != 0.0f) {
    Octaves octaves;
    octaves.detail = is_finite(args.f(3)) ? std::clamp(args.f(3), 0.0f, 15.0f) : 0.0f;
    octaves.roughness = saturate(args.f(5));
    phase += args.f(2) * (fbm(p * args.f(4), octaves) * 2.0f - 1.0f);
  }
  out[0] = splat(wave_profile((args.mode >> 3) & 3, phase));
}

void magic_op(const OpArgs& args, Vec4* out) {
  const Vec3 p = args.v(0) * args.f(1);
  const int depth = static_cast<int>(std::min(args.mode, 10u));
  const float d = args.f(2);
  float x = std::sin((p.x + p.y + p.z) * 5.0f);
  float y = std::cos((-p.x + p.y - p.z) * 5.0f);
  float z = -std::cos((-p.x - p.y + p.z) * 5.0f);
  if (depth > 0) {
    x *= d;
    y *= d;
    z *= d;
    y = -std::cos(x - y + z) * d;
  }
  if (depth > 1) x = std::cos(x - y - z) * d;
  if (depth > 2) z = std::sin(-x - y - z) * d;
  if (depth > 3) x = -std::cos(-x + y - z) * d;
  if (depth > 4) y = -std::sin(-x + y + z) * d;
  if (depth > 5) y = -std::cos(-x + y + z) * d;
  if (depth > 6) x = std::cos(x + y + z) * d;
  if (depth > 7) z = std::sin(x + y - z) * d;
  if (depth > 8) x = -std::cos(-x - y + z) * d;
  if (depth > 9) y = -std::sin(x - y + z) * d;
  const float scale = d != 0.0f ? 0.5f / d : 1.0f;
  const Vec3 color = Vec3(0.5f) - Vec3(x, y, z) * scale;
  out[0] = value(color);
  out[1] = splat(mean_component(color));
}

void brick_op(const OpArgs& args, Vec4* out) {
  const Vec3 p = args.v(0) * args.f(4);
  const float mortar_size = args.f(5), mortar_smooth = args.f(6), bias = args.f(7), row_height = args.f(9);
  float width = args.f(8), shift = 0.0f;
  const int row = to_int(std::floor(safe_divide(p.y, row_height)));
  const int offset_frequency = to_int(args.floats[1]), squash_frequency = to_int(args.floats[3]);
  if (offset_frequency != 0 && squash_frequency != 0) {
    width *= every(row, squash_frequency) ? args.floats[2] : 1.0f;
    shift = every(row, offset_frequency) ? width * args.floats[0] : 0.0f;
  }
  const int number = to_int(std::floor(safe_divide(p.x + shift, width)));
  const float x = p.x + shift - width * static_cast<float>(number), y = p.y - row_height * static_cast<float>(row);
  const float tint =
      saturate(brick_tint((static_cast<uint32_t>(row) << 16) + (static_cast<uint32_t>(number) & 0xFFFFu)) + bias);
  const float border = std::min(std::min(x, y), std::min(width - x, row_height - y));
  float mortar = 0.0f;
  if (border < mortar_size) {
    const float depth = 1.0f - border / mortar_size;
    mortar = mortar_smooth == 0.0f   ? 1.0f
             : depth < mortar_smooth ? smoothstep(0.0f, 1.0f, depth / mortar_smooth)
                                     : 1.0f;
  }
  const Vec3 tinted = args.v(1) * (1.0f - tint) + args.v(2) * tint;
  out[0] = value(tinted * (1.0f - mortar) + args.v(3) * mortar);
  out[1] = splat(mortar);
}

}  // namespace gradus::shading
