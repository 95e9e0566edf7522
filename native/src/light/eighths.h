// Shares of light samples that a digital net divides evenly.
#pragma once

#include <cmath>

namespace gradus::light {

// The smallest share. A digital net divides into eighths with exactly proportional numbers of points.
inline constexpr double kEighth = 0.125;

// Rounds a share from 0 to 1 to eighths.
inline double in_eighths(double share) { return std::round(share / kEighth) * kEighth; }

}  // namespace gradus::light
