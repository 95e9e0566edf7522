// Bounds of the alpha of reconstructed pixels, by what the samples around them show.
#pragma once

#include <vector>

#include "film/film.h"

namespace gradus::output {

// The range in which the alpha of a pixel lies.
struct AlphaBounds {
  float least = 0.0f, most = 1.0f;
};

// Returns bounds for each pixel of the film's region. Where all n samples of a square around the pixel have an alpha of
// 1, alpha is at least 1 − 3/n, and where all have 0, at most 3/n: what all n samples miss covers less than 3/n of the
// square, with a confidence of 95 %. The largest of the squares of 3×3 to 9×9 pixels that are uniform counts, with as
// many samples for each pixel as the one in the middle has. A regression alone mixes opaque pixels with empty ones that
// look alike, as mirrors look like what lies beside them. The film must have alpha.
std::vector<AlphaBounds> find_alpha_bounds(const film::Film& film);

}  // namespace gradus::output
