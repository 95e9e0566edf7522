// Solver for the normal equations of eight windows side by side, one in each lane of a vector.
#pragma once

namespace gradus::reconstruct {

using Lanes = float __attribute__((vector_size(32)));

inline constexpr int kLanes = 8;

// Returns the index of (i, j), j <= i, in the row-major lower triangle of a symmetric matrix.
constexpr int packed(int i, int j) { return i * (i + 1) / 2 + j; }

// Solves M a = R for C right sides by M = L D Lᵀ (no square roots), in place: `matrix` becomes L and D, and `right` the
// solutions, where right[C·i + c] is coefficient i of side c. M is positive semidefinite except for rounding. A pivot
// that is negligible after rounding counts as infinite, which sets its coefficient to 0. Unrolling saves a third of the
// time.
template <int P, int C>
inline void solve_windows(Lanes* matrix, Lanes* right) {
  const Lanes zero{}, minimum = zero + 1e-30f;
  Lanes inverse[P];
#pragma GCC unroll 16
  for (int j = 0; j < P; ++j) {
    Lanes scaled[P] = {}, pivot = matrix[packed(j, j)];
    const Lanes negligible = 2e-6f * pivot + minimum;
    for (int k = 0; k < j; ++k) {
      scaled[k] = matrix[packed(j, k)] * matrix[packed(k, k)];
      pivot -= matrix[packed(j, k)] * scaled[k];
    }
    matrix[packed(j, j)] = pivot > negligible ? pivot : zero;
    inverse[j] = pivot > negligible ? 1.0f / pivot : zero;
#pragma GCC unroll 16
    for (int i = j + 1; i < P; ++i) {
      Lanes sum = matrix[packed(i, j)];
      for (int k = 0; k < j; ++k) sum -= matrix[packed(i, k)] * scaled[k];
      matrix[packed(i, j)] = sum * inverse[j];
    }
  }
  // All right sides are solved at once, because each is a chain of operations that depend on one another.
#pragma GCC unroll 16
  for (int i = 1; i < P; ++i) {
    Lanes sums[C];
    for (int c = 0; c < C; ++c) sums[c] = right[C * i + c];
    for (int k = 0; k < i; ++k) {
      const Lanes factor = matrix[packed(i, k)];
      for (int c = 0; c < C; ++c) sums[c] -= factor * right[C * k + c];
    }
    for (int c = 0; c < C; ++c) right[C * i + c] = sums[c];
  }
#pragma GCC unroll 16
  for (int i = P - 1; i >= 0; --i) {
    Lanes sums[C];
    for (int c = 0; c < C; ++c) sums[c] = inverse[i] * right[C * i + c];
    for (int k = i + 1; k < P; ++k) {
      const Lanes factor = matrix[packed(k, i)];
      for (int c = 0; c < C; ++c) sums[c] -= factor * right[C * k + c];
    }
    for (int c = 0; c < C; ++c) right[C * i + c] = sums[c];
  }
}

}  // namespace gradus::reconstruct
