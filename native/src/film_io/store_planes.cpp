#include "film_io/store_planes.h"

#include <algorithm>

#include "film/planes.h"

namespace gradus::film_io {

std::vector<StoredPart> stored_parts(film::Film* film) {
  std::vector<StoredPart> parts;
  for (const film::Plane& plane : film::planes_of(film)) {
    auto part = std::ranges::find(parts, plane.part, &StoredPart::name);
    if (part == parts.end()) part = parts.insert(parts.end(), {plane.part, {}});
    for (const film::PlaneField& field : plane.fields)
      part->planes.push_back(
          {plane.layer + "." + field.name, field.is_integer, plane.data() + field.offset, plane.pixel_bytes});
  }
  // Parts of single channels come before the part of all others.
  std::ranges::stable_partition(parts, [](const StoredPart& part) { return part.name != "passes"; });
  return parts;
}

}  // namespace gradus::film_io
