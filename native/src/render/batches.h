// The schedule of batches: which samples of all pixels are taken together.
#pragma once

#include <algorithm>
#include <cstdint>

namespace gradus::render {

inline constexpr uint32_t kMaxBatch = 16;

// Returns the end of the batch that begins at sample `begin`, at most `samples`. Batches end at 1, 2, 4, 8, 16, and
// then at every multiple of 16. The first ones are small so that an image appears at once. The ends do not depend on
// where a render was resumed.
inline uint32_t batch_end(uint32_t begin, uint32_t samples) {
  uint32_t end = 1;
  while (end <= begin && end < kMaxBatch) end *= 2;
  if (begin >= kMaxBatch) end = (begin / kMaxBatch + 1) * kMaxBatch;
  return std::min(end, samples);
}

}  // namespace gradus::render
