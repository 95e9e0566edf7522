// File names of frames in a folder of stored films.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

namespace gradus::film_io {

// Returns a name such as "f+0000017.base.exr". `ending` follows the number.
inline std::string frame_name(int32_t frame, const char* ending) {
  std::array<char, 40> name{};
  std::snprintf(name.data(), name.size(), "f%+08d.%s", frame, ending);
  return name.data();
}

}  // namespace gradus::film_io
