// Reading of files into memory.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"

namespace gradus::image {

// Reads a whole file. Returns false, with the reason in *problem, if it is not a readable regular file of at most 16
// GiB.
bool read_file(const std::string& path, std::vector<uint8_t>* bytes, std::string* problem);

}  // namespace gradus::image
