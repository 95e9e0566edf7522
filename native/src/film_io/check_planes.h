// Checks values that a damaged file may hold and no film does.
#pragma once

#include "film/film.h"

namespace gradus::film_io {

// Checks the planes for passes of components, with the threads of the caller's task arena. Throws `invalid_argument`
// for a value that is not finite or out of range.
void check_planes(const film::Film& film);

}  // namespace gradus::film_io
