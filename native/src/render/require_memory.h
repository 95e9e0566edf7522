// What is refused before it begins, for the machine has not the memory.
#pragma once

#include <cstdint>
#include <string>

#include "base/clock.h"
#include "base/error.h"

namespace gradus {

// Throws the Error OUT_OF_MEMORY: `what` needs more than the machine has, and what to do about it.
inline void require_memory(const std::string& what, uint64_t bytes, const std::string& way_out) {
  const uint64_t available = machine_memory_bytes();
  if (available == 0 || bytes <= available) return;
  const auto mebibytes = [](uint64_t b) { return std::to_string(b >> 20) + " MiB"; };
  throw Error(GRADUS_ERROR_OUT_OF_MEMORY,
              what + " needs " + mebibytes(bytes) + ", the machine has " + mebibytes(available) + ": " + way_out);
}

}  // namespace gradus
