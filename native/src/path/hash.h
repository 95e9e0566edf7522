// Integer hashes for sample keys.
#pragma once

#include <cstdint>

namespace gradus::path {

// Bijective mix of 32 bits ("lowbias32" of Wellons' search for low-bias multiply-xorshift hashes).
inline uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

// Order matters: combine(a, b) differs from combine(b, a).
inline uint32_t combine(uint32_t seed, uint32_t value) {
  return mix(seed ^ (mix(value + 0x9e3779b9u) + (seed << 6) + (seed >> 2)));
}

}  // namespace gradus::path
