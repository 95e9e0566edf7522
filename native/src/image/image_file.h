// Whole files into memory.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"

namespace gradus::image {

// False, with a text, for what is not a readable regular file.
bool read_file(const std::string& path, std::vector<uint8_t>* bytes, std::string* problem);

}  // namespace gradus::image
