// Reading passes out of a frame: means, quotients and differences of its sums, cropped to what is delivered.
#pragma once

#include <cstdint>

#include "film/film.h"

namespace gradus::output {

// Writes width·height·channels floats of `region` (inside the frame's region; row 0 is the bottom). Combined is the
// noisy image here. Throws invalid_operation with the pass's name if the frame has no plane for it. Pixels without
// samples are 0. Rows are read by the threads of the caller's arena.
void read_film_pass(const film::Film& film, uint32_t pass, const Region& region, float* pixels);

// Whether the frame can give the pass.
bool has_pass(const film::Film& film, uint32_t pass);

}  // namespace gradus::output
