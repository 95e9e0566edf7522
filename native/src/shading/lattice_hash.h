// Hashes of lattice points and floats by Bob Jenkins' lookup3 (the "final" and "mix" steps), as in Blender's textures.
#pragma once

#include <bit>
#include <cstdint>

#include "base/types.h"

namespace gradus::shading {

namespace detail {
inline void jenkins_final(uint32_t& a, uint32_t& b, uint32_t& c) {
  c = (c ^ b) - std::rotl(b, 14);
  a = (a ^ c) - std::rotl(c, 11);
  b = (b ^ a) - std::rotl(a, 25);
  c = (c ^ b) - std::rotl(b, 16);
  a = (a ^ c) - std::rotl(c, 4);
  b = (b ^ a) - std::rotl(a, 14);
  c = (c ^ b) - std::rotl(b, 24);
}
inline void jenkins_mix(uint32_t& a, uint32_t& b, uint32_t& c) {
  a = (a - c) ^ std::rotl(c, 4);
  c += b;
  b = (b - a) ^ std::rotl(a, 6);
  a += c;
  c = (c - b) ^ std::rotl(b, 8);
  b += a;
  a = (a - c) ^ std::rotl(c, 16);
  c += b;
  b = (b - a) ^ std::rotl(a, 19);
  a += c;
  c = (c - b) ^ std::rotl(b, 4);
  b += a;
}
constexpr uint32_t jenkins_start(uint32_t words) { return 0xdeadbeefu + (words << 2) + 13u; }
}  // namespace detail

inline uint32_t lattice_hash(uint32_t x) {
  uint32_t a = detail::jenkins_start(1), b = a, c = a;
  a += x;
  detail::jenkins_final(a, b, c);
  return c;
}
inline uint32_t lattice_hash(uint32_t x, uint32_t y) {
  uint32_t a = detail::jenkins_start(2), b = a, c = a;
  a += x;
  b += y;
  detail::jenkins_final(a, b, c);
  return c;
}
inline uint32_t lattice_hash(uint32_t x, uint32_t y, uint32_t z) {
  uint32_t a = detail::jenkins_start(3), b = a, c = a;
  a += x;
  b += y;
  c += z;
  detail::jenkins_final(a, b, c);
  return c;
}
inline uint32_t lattice_hash(uint32_t x, uint32_t y, uint32_t z, uint32_t w) {
  uint32_t a = detail::jenkins_start(4), b = a, c = a;
  a += x;
  b += y;
  c += z;
  detail::jenkins_mix(a, b, c);
  a += w;
  detail::jenkins_final(a, b, c);
  return c;
}

// Returns a number in 0…1 that is the hash of 1 to 4 integers.
template <class... Integers>
float unit_hash(Integers... x) {
  return static_cast<float>(lattice_hash(x...)) * (1.0f / static_cast<float>(0xFFFFFFFFu));
}

// Returns a number in 0…1 that is the hash of the bits of 1 to 4 floats.
template <class... Floats>
float float_hash(Floats... x) {
  return unit_hash(std::bit_cast<uint32_t>(x)...);
}

}  // namespace gradus::shading
