// Checks of (pointer, count) arguments.
#pragma once

#include <cstdint>
#include <string>

#include "api/structs.h"
#include "base/error.h"

namespace gradus::api {

enum class Presence { Required, Optional };

// Elements are `width` values of T each. Throws invalid_argument with the array's name if it is missing, misaligned or
// absurdly long.
template <class T>
void check_array(const T* data, size_t count, const char* name, size_t width = 1,
                 Presence presence = Presence::Required) {
  if (count > kMaxCount || count * width > kMaxCount * size_t{16}) {
    throw invalid_argument(std::string(name) + ": " + std::to_string(count) + " elements are too many");
  }
  if (count == 0) return;
  if (!data) {
    if (presence == Presence::Optional) return;
    throw invalid_argument(std::string(name) + " is NULL");
  }
  if (reinterpret_cast<uintptr_t>(data) % alignof(T) != 0) throw invalid_argument(std::string(name) + " is misaligned");
}

inline const char* text_or_empty(const char* text) { return text ? text : ""; }

}  // namespace gradus::api
