#pragma once

#include <cstdint>

namespace gradus {

// Concurrency of an arena for so many threads: no more than TBB has, which would print a warning.
int arena_size(uint32_t threads);

}  // namespace gradus
