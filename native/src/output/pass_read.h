// Reads passes from a film: means, quotients and differences of its sums, cropped to the requested region.
#pragma once

#include <cstdint>

#include "film/film.h"

namespace gradus::output {

// Writes width·height·channels floats of `region`, which must lie inside the film's region; row 0 is the bottom row.
// The noisy image serves as Combined. Pixels without samples are 0. Throws invalid_operation with the name of the pass
// if the film has no plane for it. The threads of the caller's TBB arena read the rows in parallel.
void read_film_pass(const film::Film& film, uint32_t pass, const Region& region, float* pixels);

// Writes a layer of a channel that belongs to no pass in the same way. A layer of identifiers and weights holds two
// pairs; the pairs of a pixel are sorted by falling weight. Others have the layer 0 alone. Throws invalid_argument if
// there is no such layer.
void read_film_channel(const film::Film& film, const film::Channel& channel, uint32_t layer, const Region& region,
                       float* pixels);

// Returns whether read_film_pass() can read the pass from this film.
bool has_pass(const film::Film& film, uint32_t pass);

}  // namespace gradus::output
