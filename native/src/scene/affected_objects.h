// Collects the objects that have the same problem, for one warning with the name of the first.
#pragma once

#include <string>
#include <vector>

namespace gradus::scene {

struct AffectedObjects {
  size_t count = 0;
  std::string first;

  void add(const std::string& name) {
    if (count++ == 0) first = name;
  }
  // Appends the warning, if there are objects. `what` is the predicate for one object, `of_several` that for more.
  void warn(const std::string& what, const std::string& of_several, const std::string& why,
            std::vector<std::string>* warnings) const {
    if (count == 0) return;
    warnings->push_back(count == 1 ? "object '" + first + "' " + what + ": " + why
                                   : std::to_string(count) + " objects " + of_several + ", the first is '" + first +
                                         "': " + why);
  }
};

}  // namespace gradus::scene
