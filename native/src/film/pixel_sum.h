// The sum of all samples of a pixel.
#pragma once

#include "film/film.h"

namespace gradus::film {

// Returns the sum of a pixel's samples over all components and both half-buffers; w is the sum of their alpha.
inline Radiance sum_at(const Film& film, size_t i) {
  Radiance sum(0.0f);
  for (const ComponentPlanes& component : film.components) sum += component.primal[0][i] + component.primal[1][i];
  return sum;
}

}  // namespace gradus::film
