// The one gate into a frame: what is not finite, or would make a sum so, stays out and is counted by cause
// (architecture rule 2).
#pragma once

#include <algorithm>
#include <cmath>

#include "film/film.h"

namespace gradus::film {

// Largest sum: what is read is the mean of two halves or the difference of two ends, which then have room in float.
inline constexpr float kLargestSum = 1e37f;

// Written so that NaN does not fit.
inline bool fits(float v) { return std::fabs(v) <= kLargestSum; }
inline bool fits(const Radiance& v) { return fits(v.x) && fits(v.y) && fits(v.z) && fits(v.w); }

// One sample of a pixel. A dropped value counts as 0: the sample itself has been taken.
inline void add_radiance(const Radiance& value, Radiance* sum, Counters* counters) {
  const Radiance next = *sum + value;
  if (fits(next)) {
    *sum = next;
  } else {
    ++counters->nonfinite_radiance;
  }
}

// Gradient sample of a pair, already weighted (gradient/pair.h).
inline void add_gradient(const Radiance& value, Radiance* sum, Counters* counters) {
  const Radiance next = *sum + value;
  if (fits(next)) {
    *sum = next;
  } else {
    ++counters->nonfinite_gradient;
  }
}

// A vertex of one sample.
inline void add_non_specular(const NonSpecularVertices& vertex, NonSpecularVertices* sum, Counters* counters) {
  const NonSpecularVertices next{sum->reflectance + vertex.reflectance, sum->normal + vertex.normal,
                                 sum->inverse_depth + vertex.inverse_depth, sum->samples + vertex.samples};
  if (fits(Radiance(next.reflectance, next.inverse_depth)) && fits(Radiance(next.normal, next.samples))) {
    *sum = next;
  } else {
    ++counters->nonfinite_feature;
  }
}

// Of a segment of one sample, or of other samples: the first of all tells which object and face it is.
inline void add_details(const NonSpecularDetails& more, NonSpecularDetails* sum, Counters* counters) {
  NonSpecularDetails next = more.sample < sum->sample ? more : *sum;
  next.uv = sum->uv + more.uv;
  next.emission = sum->emission + more.emission;
  next.segments = sum->segments + more.segments;
  if (fits(Radiance(next.uv, next.segments)) && fits(Radiance(next.emission, next.object))) {
    *sum = next;
  } else {
    ++counters->nonfinite_feature;
  }
}

// Values of a pass: added to its sums, or kept as they are where only the first sample counts.
inline void add_feature(const float* values, float weight, size_t pixel, int half, PassPlane* plane,
                        Counters* counters) {
  float* sum = plane->of_half(half).data() + pixel * plane->channels;
  float next[4];
  for (uint32_t i = 0; i < plane->channels; ++i) {
    next[i] = plane->first_sample_only ? values[i] : sum[i] + values[i] * weight;
    if (!fits(next[i])) {
      ++counters->nonfinite_feature;
      return;
    }
  }
  std::copy_n(next, plane->channels, sum);
  if (plane->skips_transparent) {
    plane->weight[pixel] += weight;
  }
}

}  // namespace gradus::film
