// Fractal noise: sums and products of noise over octaves (Musgrave, in "Texturing and Modeling", ch. 16), in the form
// of Blender's Noise Texture. A point P is a float or a vector of 2 to 4 dimensions.
#pragma once

#include <algorithm>
#include <cmath>

#include "gradus/gradus_nodes.h"
#include "shading/perlin.h"

namespace gradus::shading {

// Parameters of the Noise Texture.
struct Octaves {
  // Number of octaves beyond the first; its fraction blends in one more octave. At -1 there is none.
  float detail = 0.0f;
  float roughness = 0.0f;
  float lacunarity = 2.0f;
  float offset = 0.0f;
  float gain = 0.0f;
  bool normalize = true;
  int count() const { return static_cast<int>(std::floor(detail)); }
  float octave_fraction() const { return detail - std::floor(detail); }
};

template <class P>
float fbm(P p, const Octaves& o) {
  float frequency = 1.0f, amplitude = 1.0f, total = 0.0f, sum = 0.0f;
  for (int i = 0; i <= o.count(); i++) {
    sum += signed_noise(p * frequency) * amplitude;
    total += amplitude;
    amplitude *= o.roughness;
    frequency *= o.lacunarity;
  }
  const auto scaled = [&](float s, float t) { return o.normalize ? 0.5f * s / t + 0.5f : s; };
  if (o.octave_fraction() == 0.0f) return scaled(sum, total);
  const float more = sum + signed_noise(p * frequency) * amplitude;
  return scaled(sum, total) * (1.0f - o.octave_fraction()) + scaled(more, total + amplitude) * o.octave_fraction();
}

template <class P>
float multifractal(P p, const Octaves& o) {
  float result = 1.0f, power = 1.0f;
  for (int i = 0; i <= o.count(); i++) {
    result *= power * signed_noise(p) + 1.0f;
    power *= o.roughness;
    p *= o.lacunarity;
  }
  return o.octave_fraction() != 0.0f ? result * (o.octave_fraction() * power * signed_noise(p) + 1.0f) : result;
}

template <class P>
float hetero_terrain(P p, const Octaves& o) {
  float power = o.roughness, result = o.offset + signed_noise(p);
  p *= o.lacunarity;
  for (int i = 1; i <= o.count(); i++) {
    result += (signed_noise(p) + o.offset) * power * result;
    power *= o.roughness;
    p *= o.lacunarity;
  }
  return o.octave_fraction() != 0.0f ? result + o.octave_fraction() * (signed_noise(p) + o.offset) * power * result
                                     : result;
}

template <class P>
float hybrid_multifractal(P p, const Octaves& o) {
  float power = 1.0f, result = 0.0f, weight = 1.0f;
  for (int i = 0; weight > 0.001f && i <= o.count(); i++) {
    weight = std::min(weight, 1.0f);
    const float signal = (signed_noise(p) + o.offset) * power;
    power *= o.roughness;
    result += weight * signal;
    weight *= o.gain * signal;
    p *= o.lacunarity;
  }
  if (o.octave_fraction() != 0.0f && weight > 0.001f)
    result += o.octave_fraction() * std::min(weight, 1.0f) * (signed_noise(p) + o.offset) * power;
  return result;
}

template <class P>
float ridged_multifractal(P p, const Octaves& o) {
  const auto ridge = [&](const P& q) {
    const float s = o.offset - std::fabs(signed_noise(q));
    return s * s;
  };
  float power = o.roughness, signal = ridge(p), result = signal;
  for (int i = 1; i <= o.count(); i++) {
    p *= o.lacunarity;
    signal = ridge(p) * std::clamp(signal * o.gain, 0.0f, 1.0f);
    result += signal * power;
    power *= o.roughness;
  }
  return result;
}

// Evaluates the fractal noise of a GRADUS_NOISE_ type.
template <class P>
float fractal_noise(uint32_t type, const P& p, const Octaves& o) {
  switch (type) {
    case GRADUS_NOISE_MULTIFRACTAL:
      return multifractal(p, o);
    case GRADUS_NOISE_HYBRID_MULTIFRACTAL:
      return hybrid_multifractal(p, o);
    case GRADUS_NOISE_RIDGED_MULTIFRACTAL:
      return ridged_multifractal(p, o);
    case GRADUS_NOISE_HETERO_TERRAIN:
      return hetero_terrain(p, o);
    default:
      return fbm(p, o);
  }
}

}  // namespace gradus::shading
