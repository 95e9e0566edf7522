// Parses the names of passes of a frame or of its components as users type them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace gradus::tool {

struct PassNames {
  uint32_t count;
  std::function<std::string(uint32_t pass)> of;  // Returns the name as users type it.
  std::string unknown, known;                    // Texts of an error: "there is no pass ", "; there are ".
};

// Returns the bit mask of names that are separated by commas ("depth, diffuse_direct"), or of "all". Case is ignored,
// and
// '_', '-' and ' ' are equal. Throws Error, with the available names, for an unknown name.
uint64_t parse_names(const PassNames& names, const std::string& text);

struct AvailablePasses {
  uint64_t mask = 0;
  std::string names, missing;  // Lists of the available passes, and of the requested ones that are not available.
};
AvailablePasses find_available(const PassNames& names, uint64_t requested,
                               const std::function<bool(uint32_t pass)>& holds);

}  // namespace gradus::tool
