#include "sampling/sampler.h"

#include "sampling/hash.h"

namespace gradus {

namespace {

uint32_t reverse_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

// Owen scrambling by a hash in which bit i depends only on bits below it: Laine and Karras 2011, in the form of Burley 2020 ("Practical
// Hash-based Owen Scrambling"), with Vegdahl's constants. Works on bit-reversed values.
uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Second Sobol dimension, bit-reversed: Pascal's matrix mod 2, which is a Kronecker power and so factors into log₂ 32 steps.
uint32_t pascal(uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ ((x >> 16) & 0x0000ffffu);
}

// The 24 high bits, so that the result stays below 1.
float to_unit(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

}  // namespace

Sampler::Sampler(const SampleKey& key, bool independent) : index_(key.index >> 1), independent_(independent) {
  uint32_t h = combine(0x67726164u, key.seed);
  h = combine(h, static_cast<uint32_t>(key.kind));
  h = combine(h, key.stream);
  h = combine(h, static_cast<uint32_t>(key.stream_frame));
  stream_hash_ = combine(h, key.index & 1u);  // the half: its own shuffle and scramble
}

Vec2 Sampler::get2(uint32_t block) const {
  const uint32_t seed = combine(stream_hash_, block);
  if (independent_) {
    const uint32_t h = combine(seed, index_);
    return Vec2(to_unit(h), to_unit(mix(h ^ 0x5bd1e995u)));
  }
  // Padding: each block is the same 2-D net, its points in an order of its own.
  const uint32_t index = reverse_bits(scramble_reversed(reverse_bits(index_), seed));
  const uint32_t x = reverse_bits(scramble_reversed(index, mix(seed ^ 0x68bc21ebu)));
  const uint32_t y = reverse_bits(scramble_reversed(pascal(index), mix(seed ^ 0x02e5be93u)));
  return Vec2(to_unit(x), to_unit(y));
}

}  // namespace gradus
