// The parts of a stored film and their channels, in one list for writing and reading.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "film/film.h"

namespace gradus::film_io {

// One channel: `data` holds 32-bit values of the pixel (0, 0) of the frame's region and so on, `stride` bytes apart,
// row after row.
struct StoredPlane {
  std::string name;  // of the channel in the file; no other part has it, so that a reader may throw the parts together
  bool integer = false;
  unsigned char* data = nullptr;
  size_t stride = 0;
};

// What belongs together and packs alike: samples and gradients, of each component by itself, so that one can be read
// without the others; counts, pairs, each feature, passes. There is none without channels. All is in 32 bits: half
// would do for the means of features (REGULARIZED's error changes by less than a thousandth), but a render that goes on
// from rounded sums has other bits than one that was never stored (contract 2.1).
struct StoredPart {
  std::string name;
  std::vector<StoredPlane> planes;
};

// Returns parts that point into the film, whose planes must not change while they are used.
std::vector<StoredPart> stored_parts(film::Film* film);

}  // namespace gradus::film_io
