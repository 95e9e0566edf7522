// What a file may hold and no frame does: what was sampled has passed the gate, and what was found is bounded.
#pragma once

#include "film/film.h"

namespace gradus::film_io {

// Of what passes of components are made of, by the threads of the caller's arena. Throws invalid_argument.
void check_planes(const film::Film& film);

}  // namespace gradus::film_io
