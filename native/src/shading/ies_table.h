// The table of an IES operation: intensities of a luminaire by angle, in radians.
#pragma once

#include <cstdint>
#include <optional>

namespace gradus::shading {

struct IesTable {
  int horizontal_count = 0, vertical_count = 0;  // At least 2.
  const float* horizontal = nullptr;             // Angles about the axis, increasing, within 0…2π.
  const float* vertical = nullptr;               // Angles from straight down, increasing, within 0…π.
  const float* values = nullptr;                 // All vertical angles of the first horizontal one, then of the next.
};

// Returns the table in the floats of an IES operation: the number of horizontal angles, the horizontal angles, the
// vertical angles, the values. Returns nothing if their number does not fit.
std::optional<IesTable> ies_table(const float* floats, uint64_t count);

}  // namespace gradus::shading
