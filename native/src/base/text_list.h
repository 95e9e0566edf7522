// Lists in messages for the user.
#pragma once

#include <string>

namespace gradus {

// Appends `item` to a list of the form "a, b, c".
inline void add_item(std::string* list, const std::string& item) {
  if (!list->empty()) *list += ", ";
  *list += item;
}

}  // namespace gradus
