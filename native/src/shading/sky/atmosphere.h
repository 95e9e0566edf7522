// What the simulated skies share: rays through the atmosphere, and how air scatters.
#pragma once

#include <cmath>

#include "base/types.h"

namespace gradus::shading {

// A ray, given by the distance of its origin from the Earth's centre and the cosine to the zenith there.
struct PolarRay {
  double radius, cosine;
  double radius_at(double t) const { return std::sqrt(radius * radius + 2.0 * radius * cosine * t + t * t); }
};

// Returns the phase function of air, for the cosine between both directions.
inline float rayleigh_phase(float mu) { return 3.0f / 16.0f * kInvPi * (1.0f + mu * mu); }

}  // namespace gradus::shading
