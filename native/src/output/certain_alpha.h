// The alpha of pixels that are surely opaque or empty, which a reconstruction must not change.
#pragma once

#include <cstdint>
#include <vector>

#include "film/film.h"

namespace gradus::output {

enum class CertainAlpha : uint8_t { None, Empty, Opaque };

// Returns for each pixel of the film's region whether all samples of the 3×3 pixels around it have an alpha of 0 or of
// 1 (Empty, Opaque). A regression mixes such pixels with others that look alike, as reflections of the same things do
// in opaque mirrors and beside them. At edges, where few samples may all fall on one side by chance, the answer is
// None. The film must have alpha.
std::vector<CertainAlpha> find_certain_alpha(const film::Film& film);

}  // namespace gradus::output
