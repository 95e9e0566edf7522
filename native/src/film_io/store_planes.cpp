#include "film_io/store_planes.h"

#include <algorithm>

#include "film/plane_names.h"

namespace gradus::film_io {

std::vector<StoredPart> stored_parts(const std::vector<film::Plane>& planes) {
  std::vector<StoredPart> parts;
  for (const film::Plane& plane : planes) {
    auto part = std::ranges::find(parts, plane.part, &StoredPart::name);
    if (part == parts.end()) part = parts.insert(parts.end(), {plane.part, {}});
    for (const film::PlaneField& field : plane.fields)
      part->planes.push_back(
          {plane.layer + "." + field.name, field.is_integer, plane.data() + field.offset, plane.pixel_bytes});
  }
  // Parts of single channels come before the part of all others.
  std::ranges::stable_partition(parts, [](const StoredPart& part) { return part.name != film::plane_names::kPasses; });
  return parts;
}

}  // namespace gradus::film_io
