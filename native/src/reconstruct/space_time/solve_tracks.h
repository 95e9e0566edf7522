// Weighted least squares along every pixel's track,
//   Σ w (x − v)² + Σ c (x(φ(i), t+1) − x(i, t) − d)²,
// exactly, by elimination from the first frame to the last and back (Rauch, Tung, Striebel 1965).
#pragma once

#include <vector>

#include "reconstruct/space_time/links.h"

namespace gradus {

// From a frame to the next.
struct TrackStep {
  const Links& links;
  const Field& difference;  // d; 0 in channels that it lacks
  const Field& weight;      // c; one channel
};

// values: v, which become x. weights: w, one channel, above 0; they are used up.
void solve_tracks(const std::vector<TrackStep>& steps, std::vector<Field>* values, std::vector<Field>* weights);

}  // namespace gradus
