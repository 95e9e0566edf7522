// Hashes of lattice points and floats, as in Blender's textures. A word is a number of 32 bits, or eight of them in
// lanes; a real is a float, or eight of them.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "base/lanes.h"
#include "base/types.h"

namespace gradus::shading {

// ------------------------------------------------------------------------------------------------ Jenkins

// The "final" and "mix" steps of Bob Jenkins' lookup3.
namespace detail {
template <class Word>
Word rotate(Word v, int k) {
  return (v << k) | (v >> (32 - k));
}
template <class Word>
void jenkins_final(Word& a, Word& b, Word& c) {
  c = (c ^ b) - rotate(b, 14);
  a = (a ^ c) - rotate(c, 11);
  b = (b ^ a) - rotate(a, 25);
  c = (c ^ b) - rotate(b, 16);
  a = (a ^ c) - rotate(c, 4);
  b = (b ^ a) - rotate(a, 14);
  c = (c ^ b) - rotate(b, 24);
}
template <class Word>
void jenkins_mix(Word& a, Word& b, Word& c) {
  a = (a - c) ^ rotate(c, 4);
  c += b;
  b = (b - a) ^ rotate(a, 6);
  a += c;
  c = (c - b) ^ rotate(b, 8);
  b += a;
  a = (a - c) ^ rotate(c, 16);
  c += b;
  b = (b - a) ^ rotate(a, 19);
  a += c;
  c = (c - b) ^ rotate(b, 4);
  b += a;
}
template <class Word>
Word jenkins_start(uint32_t words) {
  return Word{} + (0xdeadbeefu + (words << 2) + 13u);
}
}  // namespace detail

template <class Word>
Word lattice_hash(Word x) {
  Word a = detail::jenkins_start<Word>(1), b = a, c = a;
  a += x;
  detail::jenkins_final(a, b, c);
  return c;
}
template <class Word>
Word lattice_hash(Word x, Word y) {
  Word a = detail::jenkins_start<Word>(2), b = a, c = a;
  a += x;
  b += y;
  detail::jenkins_final(a, b, c);
  return c;
}
template <class Word>
Word lattice_hash(Word x, Word y, Word z) {
  Word a = detail::jenkins_start<Word>(3), b = a, c = a;
  a += x;
  b += y;
  c += z;
  detail::jenkins_final(a, b, c);
  return c;
}
template <class Word>
Word lattice_hash(Word x, Word y, Word z, Word w) {
  Word a = detail::jenkins_start<Word>(4), b = a, c = a;
  a += x;
  b += y;
  c += z;
  detail::jenkins_mix(a, b, c);
  a += w;
  detail::jenkins_final(a, b, c);
  return c;
}

namespace detail {
inline uint32_t bits(float x) { return std::bit_cast<uint32_t>(x); }
inline Lanes bits(FloatLanes x) { return (Lanes)x; }
inline float real(uint32_t x) { return static_cast<float>(x); }
inline FloatLanes real(Lanes x) { return __builtin_convertvector(x, FloatLanes); }
// Returns a real, or the same float in all lanes.
template <class Real, class Other>
Real as(Other x) {
  if constexpr (std::is_same_v<Real, Other>)
    return x;
  else
    return Real{} + x;
}
}  // namespace detail

// Returns a number in 0…1 that is the hash of 1 to 4 integers.
template <class... Integers>
float unit_hash(Integers... x) {
  return detail::real(lattice_hash(x...)) * (1.0f / static_cast<float>(0xFFFFFFFFu));
}

// Returns numbers in 0…1 that are the hashes of the bits of 1 to 4 reals.
template <class Real, class... More>
Real float_hash(Real x, More... more) {
  return detail::real(lattice_hash(detail::bits(x), detail::bits(detail::as<Real>(more))...)) *
         (1.0f / static_cast<float>(0xFFFFFFFFu));
}

// Return three independent numbers in 0…1 that are hashes of the bits of 1 to 4 floats.
inline Vec3 color_hash(float x) { return Vec3(float_hash(x), float_hash(x, 1.0f), float_hash(x, 2.0f)); }
inline Vec3 color_hash(float x, float y) {
  return Vec3(float_hash(x, y), float_hash(x, y, 1.0f), float_hash(x, y, 2.0f));
}
inline Vec3 color_hash(float x, float y, float z) {
  return Vec3(float_hash(x, y, z), float_hash(x, y, z, 1.0f), float_hash(x, y, z, 2.0f));
}
inline Vec3 color_hash(float x, float y, float z, float w) {
  return Vec3(float_hash(x, y, z, w), float_hash(z, x, w, y), float_hash(w, z, y, x));
}

// ------------------------------------------------------------------------------------------------ PCG

// The hashes of Jarzynski and Olano, "Hash Functions for GPU Rendering" (2020), in the form of Blender 5.0 and later:
// numbers are signed, so that a shift to the right repeats the sign, and the sign of the result is dropped.
namespace detail {
constexpr uint32_t kPcgFactor = 1664525u, kPcgStep = 1013904223u;

inline uint32_t upper_half(uint32_t v) { return static_cast<uint32_t>(static_cast<int32_t>(v) >> 16); }
inline Lanes upper_half(Lanes v) { return (Lanes)((SignedLanes)v >> 16); }

template <class Word>
void pcg_mix(Word (&v)[2]) {
  v[0] += v[1] * kPcgFactor;
  v[1] += v[0] * kPcgFactor;
}
template <class Word>
void pcg_mix(Word (&v)[3]) {
  v[0] += v[1] * v[2];
  v[1] += v[2] * v[0];
  v[2] += v[0] * v[1];
}
template <class Word>
void pcg_mix(Word (&v)[4]) {
  v[0] += v[1] * v[3];
  v[1] += v[2] * v[0];
  v[2] += v[0] * v[1];
  v[3] += v[1] * v[2];
}
inline float real_of_31_bits(uint32_t x) { return static_cast<float>(static_cast<int32_t>(x)); }
inline FloatLanes real_of_31_bits(Lanes x) { return __builtin_convertvector((SignedLanes)x, FloatLanes); }
}  // namespace detail

// Writes numbers in 0…1 that are the hashes of the coordinates of a lattice point. 2 to 4 dimensions.
template <class Word, class Real, int D>
void pcg_hash(const Word (&point)[D], Real (&out)[D]) {
  Word v[D];
  for (int axis = 0; axis < D; axis++) v[axis] = point[axis] * detail::kPcgFactor + detail::kPcgStep;
  detail::pcg_mix(v);
  for (int axis = 0; axis < D; axis++) v[axis] ^= detail::upper_half(v[axis]);
  detail::pcg_mix(v);
  for (int axis = 0; axis < D; axis++)
    out[axis] = detail::real_of_31_bits(v[axis] & 0x7fffffffu) * (1.0f / static_cast<float>(0x7fffffffu));
}

}  // namespace gradus::shading
