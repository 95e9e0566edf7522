// The finite check, through which all values enter a film: a value that is not finite, or that would make a sum too
// large, is dropped and counted by cause.
#pragma once

#include <cmath>

#include "base/fault.h"
#include "film/film.h"

namespace gradus::film {

// Largest absolute sum. The limit leaves room in float for the mean of two half-buffers and the difference of two ends.
inline constexpr float kLargestSum = 1e37f;

// Returns whether a sum is within the limit; false for NaN.
inline bool fits(float v) { return std::fabs(v) <= kLargestSum || GRADUS_FAULT(finite_check_accepts_all); }
inline bool fits(const Radiance& v) { return fits(v.x) && fits(v.y) && fits(v.z) && fits(v.w); }

// Adds one sample of a pixel. A dropped value counts as 0, because the sample count includes the sample.
inline void add_radiance(const Radiance& value, Radiance* sum, Counters* counters) {
  const Radiance next = *sum + value;
  if (fits(next)) {
    *sum = next;
  } else {
    ++counters->nonfinite_radiance;
  }
}

// Adds the gradient sample of a pair, already weighted (gradient/gradient_accumulator.h).
inline void add_gradient(const Radiance& value, Radiance* sum, Counters* counters) {
  const Radiance next = *sum + value;
  if (fits(next)) {
    *sum = next;
  } else {
    ++counters->nonfinite_gradient;
  }
}

// Adds the first non-specular vertex of one sample.
inline void add_non_specular(const NonSpecularVertices& vertex, NonSpecularVertices* sum, Counters* counters) {
  const NonSpecularVertices next{sum->reflectance + vertex.reflectance, sum->normal + vertex.normal,
                                 sum->inverse_depth + vertex.inverse_depth, sum->samples + vertex.samples};
  if (fits(Radiance(next.reflectance, next.inverse_depth)) && fits(Radiance(next.normal, next.samples))) {
    *sum = next;
  } else {
    ++counters->nonfinite_feature;
  }
}

// Adds the details of one segment, or sums over other samples. Object and face come from the lowest sample number.
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

// Adds one sample's values of a channel to its sums, or stores them if the channel keeps only the first sample. The
// sample is dropped as a whole, with its weight, if one of the values does not fit.
inline void add_feature(const float* values, float weight, size_t pixel, int half, Channel* channel,
                        Counters* counters) {
  float* sum = channel->of_half(half).data() + pixel * channel->info.values_per_pixel;
  const uint32_t count = channel->info.values_per_pixel;
  const bool replaces = channel->keeps_first_sample();
  const auto next = [&](uint32_t i) { return replaces ? values[i] : sum[i] + values[i] * weight; };
  for (uint32_t i = 0; i < count; ++i) {
    if (!fits(next(i))) {
      ++counters->nonfinite_feature;
      return;
    }
  }
  for (uint32_t i = 0; i < count; ++i) sum[i] = next(i);
  if (channel->has_weight()) {
    channel->weight[pixel] += weight;
  }
}

// Adds a weight to an identifier of one pixel, which has `count` pairs of identifier and weight. If all of them belong
// to other identifiers, the pair with the smallest weight is dropped, which may be the new one.
inline void add_pair(float id, float weight, uint32_t count, float* pairs, Counters* counters) {
  if (!(weight > 0.0f)) {
    if (weight != 0.0f) ++counters->nonfinite_feature;
    return;
  }
  float* smallest = pairs;
  for (float* pair = pairs; pair < pairs + 2 * count; pair += 2) {
    if (pair[1] == 0.0f || pair[0] == id) {
      if (!fits(pair[1] + weight) || !is_finite(id)) {
        ++counters->nonfinite_feature;
        return;
      }
      pair[0] = id;
      pair[1] += weight;
      return;
    }
    if (pair[1] < smallest[1]) smallest = pair;
  }
  if (weight <= smallest[1]) return;
  if (!fits(weight) || !is_finite(id)) {
    ++counters->nonfinite_feature;
    return;
  }
  smallest[0] = id;
  smallest[1] = weight;
}

}  // namespace gradus::film
