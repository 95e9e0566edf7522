// Groups the planes of a film into the parts of a stored film, in one list for writing and reading.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "film/planes.h"

namespace gradus::film_io {

// One channel of the OpenEXR file. `data` points to the 32-bit value of the pixel (0, 0) of the film's region. The
// values of neighbouring pixels are `stride` bytes apart, row after row.
struct StoredPlane {
  std::string name;  // No other part has a channel of this name, so that a reader may put all parts together.
  bool integer = false;
  unsigned char* data = nullptr;
  size_t stride = 0;
};

// A part of the OpenEXR file contains planes that are read together and compress alike. Each component has its own
// parts, so that one can be read without the others. All values have 32 bits: a render that continues from rounded
// sums would not have the bits of one that was never stored.
struct StoredPart {
  std::string name;
  std::vector<StoredPlane> planes;
};

// Returns parts that point to the values of the planes, which must not move while the parts are used.
std::vector<StoredPart> stored_parts(const std::vector<film::Plane>& planes);

}  // namespace gradus::film_io
