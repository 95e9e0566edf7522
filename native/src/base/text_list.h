// Lists in texts for the user: "a, b, c".
#pragma once

#include <string>

namespace gradus {

inline void add_item(std::string* list, const std::string& item) {
  if (!list->empty()) *list += ", ";
  *list += item;
}

}  // namespace gradus
