// Weighted least squares along every pixel's track,
//   Σ w (x − v)² + Σ c (x(φ(i), t+1) − x(i, t) − d)²,
// exactly, by elimination from the first frame to the last and back (Rauch, Tung, Striebel 1965).
#pragma once

#include <algorithm>
#include <vector>

#include "reconstruct/space_time/correspondence_map.h"

namespace gradus::reconstruct {

// From a frame to the next.
struct TrackStep {
  const CorrespondenceMap& correspondence;
  const Field& difference;  // d; 0 in channels that it lacks
  const Field& weight;      // c; one channel
};

// Weight of what has this squared error, within bounds whose sums and quotients have room in float: light of any
// strength.
inline float track_weight(float error) { return std::clamp(1.0f / error, 1e-30f, 1e30f); }

// values: v, which become x. weights: w, one channel; they are used up.
void solve_tracks(const std::vector<TrackStep>& steps, std::vector<Field>* values, std::vector<Field>* weights);

}  // namespace gradus::reconstruct
