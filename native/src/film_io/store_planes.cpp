#include "film_io/store_planes.h"

#include <algorithm>
#include <string_view>

#include "film/plane_names.h"

namespace gradus::film_io {
namespace {

constexpr std::string_view kOlderNames[][2] = {
    {film::plane_names::kNonSpecular, film::plane_names::kOldNonSpecular},
    {film::plane_names::kCorrespondence, film::plane_names::kOldCorrespondence}};

// Replaces elements of a name, such as "correspondence" in "component1.correspondence.V".
void use_older_names(std::string* name) {
  for (const auto& [now, before] : kOlderNames) {
    const size_t begin = name->find(now), end = begin + now.size();
    if (begin == std::string::npos || (begin > 0 && (*name)[begin - 1] != '.')) continue;
    if (end == name->size() || (*name)[end] == '.') name->replace(begin, now.size(), before);
  }
}

}  // namespace

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

void use_older_names(std::vector<StoredPart>* parts) {
  for (StoredPart& part : *parts) {
    use_older_names(&part.name);
    for (StoredPlane& plane : part.planes) use_older_names(&plane.name);
  }
}

}  // namespace gradus::film_io
