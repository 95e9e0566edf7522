// Operations on sums per channel, as conjugate gradients need them: all channels are solved side by side, each with its
// own step sizes.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/rows.h"

namespace gradus::reconstruct {

// Returns a / b by channel; 0 for a channel that is already solved, which then no longer changes.
inline Sums quotient(const Sums& a, const Sums& b) {
  Sums q(a.size());
  for (size_t c = 0; c < a.size(); ++c) q[c] = b[c] > 0.0 ? a[c] / b[c] : 0.0;
  return q;
}

// Returns the maximum over the channels of the relative residual. `rr` holds squared norms of the residual, `bb` of the
// right side.
inline float worst(const Sums& rr, const Sums& bb) {
  double result = 0.0;
  for (size_t c = 0; c < rr.size(); ++c) result = std::max(result, bb[c] > 0.0 ? rr[c] / bb[c] : rr[c]);
  return static_cast<float>(std::sqrt(result));
}

}  // namespace gradus::reconstruct
