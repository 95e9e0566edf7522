// Eight numbers that are computed at once, one in each lane of a vector register.
#pragma once

#include <immintrin.h>

#include <cstdint>

namespace gradus::shading {

inline constexpr int kLanes = 8;
using Lanes = uint32_t __attribute__((vector_size(32)));
using SignedLanes = int32_t __attribute__((vector_size(32)));
using FloatLanes = float __attribute__((vector_size(32)));

inline constexpr FloatLanes kLaneNumber = {0, 1, 2, 3, 4, 5, 6, 7};

inline FloatLanes square_root(FloatLanes x) { return (FloatLanes)_mm256_sqrt_ps((__m256)x); }
inline FloatLanes absolute(FloatLanes x) { return (FloatLanes)((Lanes)x & 0x7fffffffu); }
// Returns a mask with bit k set where lane k of a comparison is true.
inline uint32_t mask_of(SignedLanes comparison) {
  return static_cast<uint32_t>(_mm256_movemask_ps((__m256)comparison));
}

}  // namespace gradus::shading
