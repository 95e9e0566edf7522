// Sines of angles between 0 and π whose cosine is given.
#pragma once

#include <algorithm>
#include <cmath>

namespace gradus::light {

// Returns the sine; near 0 it has few digits.
inline float sine_of(float cosine) { return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)); }
// Returns the sine with full precision also near 0.
inline float precise_sine_of(float cosine) { return std::sqrt(std::max(0.0f, (1.0f - cosine) * (1.0f + cosine))); }

}  // namespace gradus::light
