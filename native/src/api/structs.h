// Checks of structs and arrays that a caller passes. A struct of an older caller, with a smaller struct_size, is
// completed by defaults; that of a newer caller is refused.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"

namespace gradus::api {

// Maximum number of elements of any array. Indices of the API have 32 bits.
inline constexpr size_t kMaxCount = 0x7fffffff;

// Reads and checks struct_size. It accesses no other member, and works for misaligned pointers.
template <class T>
uint32_t struct_size_of(const void* from, const char* name) {
  if (!from) throw invalid_argument(std::string(name) + " is NULL");
  uint32_t size = 0;
  std::memcpy(&size, from, sizeof(size));
  if (size > sizeof(T)) {
    throw invalid_argument(std::string(name) + ".struct_size is " + std::to_string(size) + ", this library knows " +
                           std::to_string(sizeof(T)) + " bytes: the caller is newer than the library");
  }
  // A size that is a multiple of the alignment ends between two members.
  if (size < 2 * sizeof(uint32_t) || size % alignof(T) != 0) {
    throw invalid_argument(std::string(name) + ".struct_size is " + std::to_string(size) + ", expected " +
                           std::to_string(sizeof(T)));
  }
  return size;
}

// Returns a copy of a caller's struct, completed by `defaults`.
template <class T>
T read_struct(const T* from, const char* name, const T& defaults = T{}) {
  const uint32_t size = struct_size_of<T>(from, name);
  T result = defaults;
  std::memcpy(static_cast<void*>(&result), from, size);
  result.struct_size = sizeof(T);
  return result;
}

// Copies an array of structs. All elements must have the struct_size of the first one.
template <class T>
std::vector<T> read_struct_array(const T* from, size_t count, const char* name) {
  std::vector<T> result;
  if (count == 0) return result;
  if (count > kMaxCount) throw invalid_argument(std::string(name) + ": too many elements");
  const uint32_t size = struct_size_of<T>(from, name);
  const auto* bytes = reinterpret_cast<const unsigned char*>(from);
  for (size_t i = 0; i < count; ++i) {
    const auto* element = reinterpret_cast<const T*>(bytes + i * size);
    if (struct_size_of<T>(element, name) != size)
      throw invalid_argument(std::string(name) + ": elements differ in struct_size");
    result.push_back(read_struct(element, name));
  }
  return result;
}

// Writes the members that the caller's struct has, and keeps its struct_size.
template <class T>
void write_struct(T* to, T value, const char* name) {
  value.struct_size = struct_size_of<T>(to, name);
  std::memcpy(static_cast<void*>(to), &value, value.struct_size);
}

// Whether an array may be NULL.
enum class Presence { Required, Optional };

// Checks an array of `count` elements of `width` values each. Throws invalid_argument, with the array's name, if it is
// missing, misaligned or has too many elements.
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

}  // namespace gradus::api
