#include "base/hash.h"

namespace gradus {

namespace {

constexpr uint64_t kMultiplier = 0x9ddfea08eb382d69ULL;

uint64_t absorb(uint64_t state, uint64_t word) {
  state = (state ^ word) * kMultiplier;
  return state ^ (state >> 29);
}

uint64_t load(const unsigned char* p) {
  uint64_t word;
  std::memcpy(&word, p, sizeof(word));
  return word;
}

}  // namespace

// Four independent lanes, so that a mesh of a million triangles costs milliseconds: one lane waits for its multiplications.
void ContentHash::bytes(const void* data, size_t size) {
  const auto* p = static_cast<const unsigned char*>(data);
  state_ = absorb(state_, size);
  uint64_t lane[4] = {state_, state_ + 1, state_ + 2, state_ + 3};
  size_t i = 0;
  for (; i + 32 <= size; i += 32)
    for (int k = 0; k < 4; ++k) lane[k] = absorb(lane[k], load(p + i + 8 * size_t(k)));
  for (; i + 8 <= size; i += 8) lane[0] = absorb(lane[0], load(p + i));
  if (i < size) {
    uint64_t word = 0;
    std::memcpy(&word, p + i, size - i);
    lane[1] = absorb(lane[1], word);
  }
  for (const uint64_t l : lane) state_ = absorb(state_, l);
}

}  // namespace gradus
