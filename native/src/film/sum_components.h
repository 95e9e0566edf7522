// Sums the components of a film.
#pragma once

#include "film/film.h"

namespace gradus::film {

// Returns a film with one component, the sum of all components' samples and differences. It has no passes.
Film sum_components(const Film& film);

}  // namespace gradus::film
