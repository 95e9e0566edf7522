// Passes by the names that users type, of a frame or of its components.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace gradus::tool {

struct PassNames {
  uint32_t count;
  std::function<std::string(uint32_t pass)> of;  // as it is typed
  std::string unknown, known;                    // "there is no pass ", "; there are ": of a refusal
};

// Bit mask from names separated by commas ("depth, diffuse_direct", any case, '_', '-' and ' ' alike; "all"). Throws
// Error with the names there are.
uint64_t parse_names(const PassNames& names, const std::string& text);

struct AvailablePasses {
  uint64_t mask = 0;
  std::string names, missing;  // missing: those of the asked that are not held
};
AvailablePasses find_available(const PassNames& names, uint64_t requested,
                               const std::function<bool(uint32_t pass)>& holds);

}  // namespace gradus::tool
