// The schedule of batches: which samples of all pixels are taken together.
#pragma once

#include <algorithm>
#include <cstdint>

namespace gradus::render {

inline constexpr uint32_t kMaxBatch = 16;
// Maximum number of further samples of a pixel at an edge, relative to the usual one.
inline constexpr uint32_t kMaxFactorAtEdges = 4;

// Returns the end of the batch that begins at sample `begin`, at most `samples`. Batches end at 1, 2, 4, 8, 16, and
// then at every multiple of 16. The first ones are small so that an image appears at once. The ends do not depend on
// where a render was resumed.
inline uint32_t batch_end(uint32_t begin, uint32_t samples) {
  uint32_t end = 1;
  while (end <= begin && end < kMaxBatch) end *= 2;
  if (begin >= kMaxBatch) end = (begin / kMaxBatch + 1) * kMaxBatch;
  return std::min(end, samples);
}

// Returns whether a batch ends at `end` > 0 in every render of so many samples.
inline bool is_batch_end(uint32_t end) { return batch_end(end - 1, UINT32_MAX) == end; }
// Returns where that batch begins.
inline uint32_t batch_begin(uint32_t end) { return end <= kMaxBatch ? end / 2 : end - kMaxBatch; }

// Returns the number of the first further sample (render/edge_sampling.h) behind a whole batch whose first sample has
// the number `first`. The numbers are above all those of usual samples, and those of two batches differ.
inline uint32_t first_further_sample(uint32_t first) { return (1u << 26) + kMaxFactorAtEdges * first; }

}  // namespace gradus::render
