// Weighted least squares along every pixel's track,
//   Σ w (x − v)² + Σ c (x(φ(i), t+1) − x(i, t) − d)²,
// solved exactly by elimination from the first frame to the last and back substitution (Rauch, Tung, Striebel 1965).
#pragma once

#include <algorithm>
#include <vector>

#include "reconstruct/space_time/correspondence_map.h"

namespace gradus::reconstruct {

// The rows that join one frame with the next.
struct TrackStep {
  const CorrespondenceMap& correspondence;
  const Field& difference;  // d; further channels count as 0
  const Field& weight;      // c; one channel
};

// Returns the weight of a value with this squared error, within bounds whose sums and quotients fit in a float.
inline float track_weight(float error) { return std::clamp(1.0f / error, 1e-30f, 1e30f); }

// Solves for x. `values` holds v and receives x. `weights` holds w, one channel, and is overwritten.
void solve_tracks(const std::vector<TrackStep>& steps, std::vector<Field>* values, std::vector<Field>* weights);

}  // namespace gradus::reconstruct
