// The Voronoi Texture node.
#include "shading/op_functions.h"
#include "shading/scalar.h"
#include "shading/voronoi.h"

namespace gradus::shading {
namespace {

// The octaves of the texture. Those of F1 and F2 are summed, those of DISTANCE_TO_EDGE cut each other's cells.
struct CellularOctaves {
  float detail = 0.0f;  // number of octaves beyond the first; its fraction is the weight of the last one
  float roughness = 0.0f;
  float lacunarity = 2.0f;
  bool normalize = false;

  bool is_single() const { return detail == 0.0f || roughness == 0.0f; }
  int count() const { return is_single() ? 1 : static_cast<int>(std::ceil(detail)) + 1; }
  // Returns the share of octave `i` that counts.
  float share(int i) const { return static_cast<float>(i) <= detail ? 1.0f : detail - std::floor(detail); }
};

template <int D>
Feature feature_of(const Cellular& c, uint32_t feature, const Vec4& p) {
  const bool is_smooth = feature == GRADUS_VORONOI_SMOOTH_F1 && (c.smoothness != 0.0f || c.is_limited);
  return is_smooth ? smooth_closest<D>(c, p) : closest<D>(c, p, feature == GRADUS_VORONOI_F2);
}

// Returns the largest distance of a point from the closest one, or from the second closest one.
template <int D>
float longest_distance(const Cellular& c, bool second) {
  float difference[D];
  for (float& x : difference) x = 0.5f + 0.5f * c.randomness;
  return metric_length(c, difference) * (second ? 2.0f : 1.0f);
}

template <int D>
Feature fractal_feature(const Cellular& c, const CellularOctaves& octaves, uint32_t feature, const Vec4& p) {
  float frequency = 1.0f, amplitude = 1.0f, total = 0.0f;
  Feature sum;
  for (int i = 0; i < octaves.count(); i++) {
    const Feature octave = feature_of<D>(c, feature, p * frequency);
    const float weight = amplitude * octaves.share(i);
    total += weight;
    sum.distance += octave.distance * weight;
    sum.color += octave.color * weight;
    sum.position += (octave.position / frequency - sum.position) * weight;
    frequency *= octaves.lacunarity;
    amplitude *= octaves.roughness;
  }
  if (octaves.normalize) {
    sum.distance /= total * longest_distance<D>(c, feature == GRADUS_VORONOI_F2);
    sum.color /= total;
  }
  return sum;
}

template <int D>
float fractal_edge(const Cellular& c, const CellularOctaves& octaves, const Vec4& p) {
  const float longest = 0.5f + 0.5f * c.randomness;
  float frequency = 1.0f, amplitude = 1.0f, total = longest, result = distance_to_edge<D>(c, p);
  for (int i = 1; i < octaves.count(); i++) {
    frequency *= octaves.lacunarity;
    amplitude *= octaves.roughness;
    const float weight = amplitude * octaves.share(i);
    const float octave = distance_to_edge<D>(c, p * frequency) / frequency;
    total += (longest / frequency - total) * weight;
    result += (std::min(result, octave) - result) * weight;
  }
  return octaves.normalize ? result / total : result;
}

template <int D>
void fill_voronoi(const Cellular& c, const CellularOctaves& octaves, uint32_t feature, float scale, const Vec4& p,
                  Vec4* out) {
  for (int i = 0; i < 5; i++) out[i] = Vec4(0.0f);
  if (feature == GRADUS_VORONOI_N_SPHERE_RADIUS) {
    out[4] = splat(sphere_radius<D>(c, p));
  } else if (feature == GRADUS_VORONOI_DISTANCE_TO_EDGE) {
    out[0] = splat(fractal_edge<D>(c, octaves, p));
  } else {
    const Feature found = fractal_feature<D>(c, octaves, feature, p);
    const Vec4 position = scale != 0.0f ? found.position / scale : Vec4(0.0f);
    out[0] = splat(found.distance);
    out[1] = value(found.color);
    if (D > 1) out[2] = value(Vec3(position));
    if (D == 1 || D == 4) out[3] = splat(position[D - 1]);
  }
}

}  // namespace

void voronoi_op(const OpArgs& args, Vec4* out) {
  const uint32_t feature = (args.mode >> 3) & 7, form = args.mode >> 9;
  Cellular c;
  c.metric = (args.mode >> 6) & 3;
  c.hash = form == GRADUS_VORONOI_FORM_INTEGERS ? CellHash::Integers : CellHash::Floats;
  c.is_limited = form == GRADUS_VORONOI_FORM_LIMITED;
  c.smoothness = 0.5f * saturate(args.f(6));
  c.exponent = args.f(7);
  c.randomness = saturate(args.f(8));
  CellularOctaves octaves;
  octaves.detail = args.f(3) > 0.0f ? std::min(args.f(3), 15.0f) : 0.0f;
  octaves.roughness = saturate(args.f(4));
  octaves.lacunarity = args.f(5);
  octaves.normalize = (args.mode >> 8) & 1;
  const float scale = args.f(2);
  const Vec3 v = args.v(0) * scale;
  const float w = args.f(1) * scale;
  switch (args.mode & 7) {
    case 1:
      return fill_voronoi<1>(c, octaves, feature, scale, Vec4(w, 0.0f, 0.0f, 0.0f), out);
    case 2:
      return fill_voronoi<2>(c, octaves, feature, scale, Vec4(v.x, v.y, 0.0f, 0.0f), out);
    case 4:
      return fill_voronoi<4>(c, octaves, feature, scale, Vec4(v, w), out);
    default:
      return fill_voronoi<3>(c, octaves, feature, scale, Vec4(v, 0.0f), out);
  }
}

}  // namespace gradus::shading
