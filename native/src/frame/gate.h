// The one gate into a frame: what is not finite stays out and is counted by cause (architecture rule 2).
#pragma once

#include "frame/frame.h"

namespace gradus {

inline bool is_finite(const Radiance& v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z) && is_finite(v.w); }

// One sample of a pixel. A dropped value counts as 0: the sample itself has been taken.
inline void add_radiance(const Radiance& value, Radiance* sum, Counters* counters) {
  if (is_finite(value)) {
    *sum += value;
  } else {
    ++counters->nonfinite_radiance;
  }
}

// Gradient sample of a pair, already weighted (integrator/gradient/pair.h).
inline void add_gradient(const Radiance& value, Radiance* sum, Counters* counters) {
  if (is_finite(value)) {
    *sum += value;
  } else {
    ++counters->nonfinite_gradient;
  }
}

// Values of a pass: added to its sums, or kept as they are where only the first sample counts.
inline void add_feature(const float* values, float weight, size_t pixel, PassPlane* plane, Counters* counters) {
  for (uint32_t i = 0; i < plane->channels; ++i) {
    if (!is_finite(values[i])) {
      ++counters->nonfinite_feature;
      return;
    }
  }
  float* sum = plane->values.data() + pixel * plane->channels;
  for (uint32_t i = 0; i < plane->channels; ++i) {
    sum[i] = plane->first_sample_only ? values[i] : sum[i] + values[i] * weight;
  }
  if (plane->skips_transparent) {
    plane->weight[pixel] += weight;
  }
}

}  // namespace gradus
