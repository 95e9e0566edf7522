// The Noise Texture, Musgrave Texture and White Noise Texture nodes.
#include "shading/fractal.h"
#include "shading/lattice_hash.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Offsets to distant points, which make the channels independent. They are those of Blender.
float shift(float seed, float) { return 100.0f + float_hash(seed) * 100.0f; }
Vec2 shift(float seed, const Vec2&) {
  return Vec2(100.0f + float_hash(seed, 0.0f) * 100.0f, 100.0f + float_hash(seed, 1.0f) * 100.0f);
}
Vec3 shift(float seed, const Vec3&) { return Vec3(shift(seed, Vec2()), 100.0f + float_hash(seed, 2.0f) * 100.0f); }
Vec4 shift(float seed, const Vec4&) { return Vec4(shift(seed, Vec3()), 100.0f + float_hash(seed, 3.0f) * 100.0f); }

template <class P>
P distort(const P& p, float amount) {
  P moved = p;
  for (int i = 0; i < P::length(); i++) moved[i] += signed_noise(p + shift(static_cast<float>(i), P())) * amount;
  return moved;
}
float distort(float p, float amount) { return p + signed_noise(p + shift(0.0f, 0.0f)) * amount; }

template <class P>
constexpr float dimension_count() {
  return static_cast<float>(P::length());
}
template <>
constexpr float dimension_count<float>() {
  return 1.0f;
}

template <class P>
void fill(uint32_t type, P p, float distortion, const Octaves& octaves, Vec4* out) {
  if (distortion != 0.0f) p = distort(p, distortion);
  const float first = fractal_noise(type, p, octaves);
  const float seed = dimension_count<P>();
  out[0] = splat(first);
  out[1] = Vec4(first, fractal_noise(type, p + shift(seed, P()), octaves),
                fractal_noise(type, p + shift(seed + 1.0f, P()), octaves), 1.0f);
}

Octaves octaves_of(const OpArgs& args) {
  Octaves o;
  const bool legacy = (args.mode >> 7) & 1;
  o.detail = std::clamp(args.f(3), 0.0f, 15.0f);
  if (!is_finite(o.detail)) o.detail = 0.0f;
  o.roughness = std::max(args.f(4), 0.0f);
  if (legacy) o.roughness = std::min(o.roughness, 1.0f);
  o.lacunarity = legacy ? 2.0f : args.f(5);
  o.offset = args.f(6);
  o.gain = args.f(7);
  o.normalize = (args.mode >> 6) & 1;
  return o;
}

}  // namespace

void noise_op(const OpArgs& args, Vec4* out) {
  const Octaves octaves = octaves_of(args);
  const uint32_t type = (args.mode >> 3) & 7;
  const float distortion = args.f(8);
  const Vec3 p = args.v(0) * args.f(2);
  const float w = args.f(1) * args.f(2);
  switch (args.mode & 7) {
    case 1:
      return fill(type, w, distortion, octaves, out);
    case 2:
      return fill(type, Vec2(p), distortion, octaves, out);
    case 4:
      return fill(type, Vec4(p, w), distortion, octaves, out);
    default:
      return fill(type, p, distortion, octaves, out);
  }
}

// The fractal increment of the Musgrave Texture stands for the roughness, and its detail counts the first octave.
void musgrave_op(const OpArgs& args, Vec4* out) {
  Octaves octaves;
  octaves.detail = (args.f(3) > 0.0f ? std::min(args.f(3), 15.0f) : 0.0f) - 1.0f;
  octaves.lacunarity = std::max(args.f(5), 1e-5f);
  octaves.roughness = std::pow(octaves.lacunarity, -std::max(args.f(4), 1e-5f));
  octaves.offset = args.f(6);
  octaves.gain = args.f(7);
  octaves.normalize = false;
  const uint32_t type = (args.mode >> 3) & 7;
  const Vec3 p = args.v(0) * args.f(2);
  const float w = args.f(1) * args.f(2);
  const auto noise = [&](const auto& q) { out[0] = splat(fractal_noise(type, q, octaves)); };
  switch (args.mode & 7) {
    case 1:
      return noise(w);
    case 2:
      return noise(Vec2(p));
    case 4:
      return noise(Vec4(p, w));
    default:
      return noise(p);
  }
}

void white_noise_op(const OpArgs& args, Vec4* out) {
  const Vec3 v = args.v(0);
  const float w = args.f(1);
  switch (args.mode) {
    case 1:
      out[1] = value(color_hash(w));
      break;
    case 2:
      out[1] = value(color_hash(v.x, v.y));
      break;
    case 4:
      out[1] = value(color_hash(v.x, v.y, v.z, w));
      break;
    default:
      out[1] = value(color_hash(v.x, v.y, v.z));
  }
  out[0] = splat(out[1].x);
}

}  // namespace gradus::shading
