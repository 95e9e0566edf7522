// Texts that leave the library are valid UTF-8, whatever names came in.
#pragma once

#include <cstddef>

namespace gradus::api {

// Copies the zero-terminated text (NULL = "") into target[capacity], zero-terminated; invalid bytes become '?', no
// character is cut.
void copy_utf8(const char* text, char* target, size_t capacity) noexcept;

}  // namespace gradus::api
