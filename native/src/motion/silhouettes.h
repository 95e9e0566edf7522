// Pixels that show an edge: more than one surface, whose motions differ.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gradus::motion {

// By pixels of the film: 1 where one of the eight around it shows another object, or a depth that its own surface does
// not lead to. `object` and `depth`: row by row; empty: not known. Depth 0 or not finite: nothing is there.
std::vector<uint8_t> silhouettes(int width, int height, std::span<const int32_t> object, std::span<const float> depth);

}  // namespace gradus::motion
