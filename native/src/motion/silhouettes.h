// Finds pixels that show an edge of an object. They show more than one surface, and the surfaces may move differently.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gradus::motion {

// Returns for each pixel of the film 1 if one of its eight neighbours shows another object, or if the depth has a step
// between it and a neighbour in its row or column; otherwise 0. `object` and `depth` hold one value for each pixel, row
// by row, or are empty if not known. A depth of 0, or one that is not finite, means that there is no surface.
std::vector<uint8_t> silhouettes(int width, int height, std::span<const int32_t> object, std::span<const float> depth);

}  // namespace gradus::motion
