// Preconditioner of a window's system: A ≈ (S + C) S⁻¹ (S + Cᵀ), block elimination from the first frame to the last,
// with one multigrid cycle per frame for S⁻¹.
//
// Elimination of frame t leaves the parallel sum B − B (B + K)⁻¹ B of its matrix B and the coupling K to the next
// frame, carried along the correspondences, like conductances in series (Anderson and Duffin 1969). For two screened
// Laplacians that is nearly a screened Laplacian again, whose screens and edges are the parallel sums ab/(a + b) of
// theirs. It is exact for very low and very high frequencies; between these it is up to 3 % too small where all weights
// are alike. So every pixel and every edge is a ladder network of its own along its track.
//
// The cycle V is not exactly S⁻¹. Where the coupling is far stronger than all else, the error would be as large. So a
// frame takes a share Θ of the next frame's values, and its cycle finds the remainder: S⁻¹K ≈ Θ + V(K − SΘ), which is
// exact for any Θ if V is. The forward elimination uses the transpose.
#pragma once

#include <memory>

#include "reconstruct/poisson/multigrid.h"
#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

class TimeLadder {
 public:
  TimeLadder(const SpaceTimeSystem& system, int channels);
  // Must be called after the system's weights have changed.
  void update();
  // Computes z ≈ A⁻¹ r and returns r·z for each frame, from the last to the first. Symmetric and positive definite.
  std::vector<RowSums> apply(const Frames& r, Frames* z);

 private:
  void carry_forth(int t, const Field& b, const Field& z, Field* next) const;
  void carry_back(int t, const Field& next, Field* b) const;
  void add_guess(int t, const Field& next, Field* z) const;

  const SpaceTimeSystem& system_;
  std::vector<Multigrid> schur_;      // B_t + K_t, where B_t includes the remainders of earlier frames
  std::vector<WeightPlane> guesses_;  // Θ
  Field solved_;                      // work space for one frame
};

}  // namespace gradus::reconstruct
