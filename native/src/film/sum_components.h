// What all components of a frame have found together.
#pragma once

#include "film/film.h"

namespace gradus::film {

// Samples and differences of a frame without decomposition: its one component is the sum of all. Without passes.
Film sum_components(const Film& film);

}  // namespace gradus::film
