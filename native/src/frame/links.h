// Links between the pixels of a frame and those of the next one.
#pragma once

#include <cstdint>

namespace gradus {

// Linked to nothing.
inline constexpr int32_t kNoLink = -1;

}  // namespace gradus
