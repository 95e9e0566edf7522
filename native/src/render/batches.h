// Which samples are taken together.
#pragma once

#include <algorithm>
#include <cstdint>

namespace gradus::render {

inline constexpr uint32_t kMaxBatch = 16;

// End of the batch that begins at sample `begin`: 1, 2, 4, 8, 16, then every 16. Small at first, so that a picture is
// there at once; the boundaries are the same wherever a render goes on.
inline uint32_t batch_end(uint32_t begin, uint32_t samples) {
  uint32_t end = 1;
  while (end <= begin && end < kMaxBatch) end *= 2;
  if (begin >= kMaxBatch) end = (begin / kMaxBatch + 1) * kMaxBatch;
  return std::min(end, samples);
}

}  // namespace gradus::render
