#include "path/sampler.h"

#include <algorithm>
#include <bit>

#include "base/random_bits.h"

namespace gradus::path {

namespace {

// Applies Owen scrambling to a bit-reversed value, by a hash in which bit i depends only on bits below it (Laine and
// Karras 2011; Burley 2020, "Practical Hash-based Owen Scrambling", with Vegdahl's constants).
uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Returns the second Sobol dimension of a bit-reversed index. Its matrix is Pascal's modulo 2, a Kronecker power, which
// factors into log₂ 32 steps.
uint32_t multiply_pascal(uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ ((x >> 16) & 0x0000ffffu);
}

// Point of a block in 32-bit fractions. All blocks are the same 2D net with its points in different orders (padding).
struct Bits {
  uint32_t x, y;
};
[[gnu::always_inline]] inline Bits net_point(uint32_t stream_hash, uint32_t block, uint32_t reversed_index) {
  const uint32_t seed = combine(stream_hash, block);
  const uint32_t index = reverse_bits(scramble_reversed(reversed_index, seed));
  return {reverse_bits(scramble_reversed(index, mix(seed ^ 0x68bc21ebu))),
          reverse_bits(scramble_reversed(multiply_pascal(index), mix(seed ^ 0x02e5be93u)))};
}

// Maximum log₂ of the samples of a pixel and half-buffer, and of the pixels, in a net. The index of a point has 32
// bits.
constexpr uint32_t kMaxLogSize = 16, kMaxLogPixels = 28;

}  // namespace

uint32_t morton_code(uint32_t x, uint32_t y) {
  const auto spread = [](uint32_t v) {
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
  };
  return spread(x & 0xffffu) | (spread(y & 0xffffu) << 1);
}

Sampler::Sampler(const SampleKey& key, bool independent) : index_(key.index >> 1), independent_(independent) {
  uint32_t h = combine(0x67726164u, key.seed);
  h = combine(h, static_cast<uint32_t>(key.kind));
  h = combine(h, key.stream);
  h = combine(h, static_cast<uint32_t>(key.stream_frame));
  stream_hash_ = combine(h, key.index & 1u);  // each half-buffer has its own shuffle and scramble
  if (key.net_samples > 0) join_net(key.net_samples, key.morton);
  reversed_index_ = reverse_bits(index_);
}

// The samples of a pixel and half-buffer are 2^k consecutive points of a net, and so are those of each aligned square
// of pixels. Samples beyond the first net take others, each with as many samples of a pixel as there are before it.
void Sampler::join_net(uint32_t samples, uint32_t morton) {
  const auto first_log_size = uint32_t(std::bit_width((samples + 1) / 2 - 1));
  const bool is_in_first = index_ >> first_log_size == 0;
  const uint32_t log_size = std::min(is_in_first ? first_log_size : uint32_t(std::bit_width(index_)) - 1, kMaxLogSize);
  const uint32_t log_pixels = std::min(32 - log_size, kMaxLogPixels);
  const uint32_t net = index_ >> log_size, square = morton >> log_pixels;
  stream_hash_ = combine(combine(stream_hash_, net), (square << 5) | log_size);
  index_ = ((morton & ((1u << log_pixels) - 1)) << log_size) | (index_ & ((1u << log_size) - 1));
}

Vec2 Sampler::get2(uint32_t block) const {
  if (independent_) {
    const uint32_t h = combine(combine(stream_hash_, block), index_);
    return Vec2(to_unit(h), to_unit(mix(h ^ 0x5bd1e995u)));
  }
  const Bits bits = net_point(stream_hash_, block, reversed_index_);
  return Vec2(to_unit(bits.x), to_unit(bits.y));
}

namespace {

uint32_t first_of_walk(int depth) { return dimension::kFirstWalk + static_cast<uint32_t>(depth) * dimension::kPerWalk; }

}  // namespace

template <uint32_t kLanes>
[[gnu::always_inline]] inline void Sampler::points(uint32_t first, float x[kLanes], float y[kLanes]) const {
  for (uint32_t i = 0; i < kLanes; ++i) {
    const Bits bits = net_point(stream_hash_, first + i, reversed_index_);
    x[i] = to_unit(bits.x);
    y[i] = to_unit(bits.y);
  }
  for (uint32_t i = 0; independent_ && i < kLanes; ++i) {
    const Vec2 u = get2(first + i);
    x[i] = u.x;
    y[i] = u.y;
  }
}

VertexSample Sampler::vertex_at(uint32_t first) const {
  constexpr uint32_t lanes = 8;
  static_assert(dimension::kRoulette < lanes);
  float x[lanes], y[lanes];
  points<lanes>(first, x, y);
  const auto at = [&](uint32_t block) { return Vec2(x[block], y[block]); };
  return {at(dimension::kBsdf), at(dimension::kLobe), at(dimension::kLight), at(dimension::kLightChoice),
          at(dimension::kRoulette)};
}

VertexSample Sampler::vertex(int depth) const {
  return vertex_at(dimension::kFirstVertex + static_cast<uint32_t>(depth) * dimension::kPerVertex);
}

VertexSample Sampler::walk_end(int depth) const {
  return vertex_at(first_of_walk(depth) + dimension::kPerStep * (dimension::kMaxSteps + 1));
}

StepSample Sampler::walk_step(int depth, uint32_t step) const {
  float x[dimension::kPerStep], y[dimension::kPerStep];
  points<dimension::kPerStep>(first_of_walk(depth) + dimension::kPerStep * step, x, y);
  return {Vec2(x[0], y[0]), Vec2(x[1], y[1]), Vec2(x[2], y[2])};
}

}  // namespace gradus::path
