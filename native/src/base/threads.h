#pragma once

#include <cstdint>

namespace gradus {

// Returns the concurrency of a TBB arena for `threads` threads: at least 1, and at most the number that TBB allows,
// because TBB prints a warning for more.
int arena_size(uint32_t threads);

}  // namespace gradus
