// struct_size: an older (smaller) struct is completed by defaults, a newer (larger) one is refused.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"

namespace gradus::api {

// Longest array that is accepted anywhere, in elements: indices of the API are 32 bit.
inline constexpr size_t kMaxCount = 0x7fffffff;

// Reads and checks struct_size without touching anything else; works for misaligned pointers.
template <class T>
uint32_t struct_size_of(const void* from, const char* name) {
  if (!from) throw invalid_argument(std::string(name) + " is NULL");
  uint32_t size = 0;
  std::memcpy(&size, from, sizeof(size));
  if (size > sizeof(T)) {
    throw invalid_argument(std::string(name) + ".struct_size is " + std::to_string(size) + ", this library knows " +
                           std::to_string(sizeof(T)) + " bytes: the caller is newer than the library");
  }
  // A multiple of the alignment never cuts a pointer or number in two.
  if (size < 2 * sizeof(uint32_t) || size % alignof(T) != 0) {
    throw invalid_argument(std::string(name) + ".struct_size is " + std::to_string(size) + ", expected " +
                           std::to_string(sizeof(T)));
  }
  return size;
}

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

// Writes as much as the caller's struct holds; its struct_size stays.
template <class T>
void write_struct(T* to, T value, const char* name) {
  value.struct_size = struct_size_of<T>(to, name);
  std::memcpy(static_cast<void*>(to), &value, value.struct_size);
}

}  // namespace gradus::api
