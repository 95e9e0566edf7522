// Eight numbers that are computed at once, one in each lane of a vector register.
#pragma once

#include <immintrin.h>

#include <cstdint>
#include <span>

namespace gradus {

inline constexpr int kLanes = 8;
using Lanes = uint32_t __attribute__((vector_size(32)));
using SignedLanes = int32_t __attribute__((vector_size(32)));
using FloatLanes = float __attribute__((vector_size(32)));

inline constexpr FloatLanes kLaneNumber = {0, 1, 2, 3, 4, 5, 6, 7};

inline FloatLanes square_root(FloatLanes x) { return (FloatLanes)_mm256_sqrt_ps((__m256)x); }
inline FloatLanes load_lanes(std::span<const float, kLanes> values) {
  return (FloatLanes)_mm256_loadu_ps(values.data());
}
inline void store_lanes(FloatLanes x, std::span<float, kLanes> values) { _mm256_storeu_ps(values.data(), (__m256)x); }
inline FloatLanes minimum(FloatLanes a, FloatLanes b) { return (FloatLanes)_mm256_min_ps((__m256)a, (__m256)b); }
inline FloatLanes maximum(FloatLanes a, FloatLanes b) { return (FloatLanes)_mm256_max_ps((__m256)a, (__m256)b); }
inline FloatLanes absolute(FloatLanes x) { return (FloatLanes)((Lanes)x & 0x7fffffffu); }
// Returns the nearest integers.
inline FloatLanes nearest_integers(FloatLanes x) {
  return (FloatLanes)_mm256_round_ps((__m256)x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
// Returns 2 to the power of integers from -126 to 127.
inline FloatLanes power_of_two(FloatLanes integers) {
  const auto exponents = (SignedLanes)_mm256_cvtps_epi32((__m256)integers);
  return (FloatLanes)((exponents + 127) << 23);
}
// Returns the sum of the lanes.
inline float sum_of_lanes(FloatLanes lanes) {
  const __m256 x = (__m256)lanes;
  __m128 sum = _mm_add_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
  sum = _mm_add_ps(sum, _mm_movehl_ps(sum, sum));
  return _mm_cvtss_f32(_mm_add_ss(sum, _mm_movehdup_ps(sum)));
}
// Returns a mask with bit k set where lane k of a comparison is true.
inline uint32_t mask_of(SignedLanes comparison) {
  return static_cast<uint32_t>(_mm256_movemask_ps((__m256)comparison));
}
// Returns the sums of the lanes up to and including each lane. They do not decrease if no lane is negative, and a lane
// of 0 adds exactly 0: each step adds the same number to neighbouring lanes.
inline FloatLanes running_sums(FloatLanes lanes) {
  const __m256 none = _mm256_setzero_ps();
  __m256 x = (__m256)lanes;
  x = _mm256_add_ps(x, _mm256_blend_ps(none, _mm256_moveldup_ps(x), 0b10101010));
  x = _mm256_add_ps(x, _mm256_blend_ps(none, _mm256_permute_ps(x, 0b01010101), 0b11001100));
  const __m256 lower_half = _mm256_permute2f128_ps(x, x, 0);
  x = _mm256_add_ps(x, _mm256_blend_ps(none, _mm256_permute_ps(lower_half, 0b11111111), 0b11110000));
  return (FloatLanes)x;
}

}  // namespace gradus
