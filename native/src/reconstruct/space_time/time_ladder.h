// The preconditioner of a window's system: A ≈ (S + C) S⁻¹ (S + Cᵀ), block elimination from the first frame to the
// last, with one multigrid cycle per frame for S⁻¹.
//
// Eliminating frame t leaves of its matrix B and the coupling K to the next frame their parallel sum B − B (B + K)⁻¹ B,
// carried along the links: conductances in series (Anderson and Duffin 1969). Of two screened Laplacians that is nearly
// a screened Laplacian again, whose screens and edges are the parallel sums ab/(a + b) of theirs: exact for what is
// smooth and for what is rough, and otherwise less than the true one by up to 3 % where all weights are alike. So every
// pixel and every edge is a ladder of its own along its track.
//
// The cycle V is not quite S⁻¹. Where the coupling is far stronger than all else, what it misses would be, too. So a
// frame takes over a share Θ of what the next one has, and its cycle finds the rest: S⁻¹K ≈ Θ + V(K − SΘ), which is
// exact for any Θ if V is. The way forth has the transpose.
#pragma once

#include <memory>

#include "reconstruct/multigrid.h"
#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

class TimeLadder {
 public:
  TimeLadder(const SpaceTimeSystem& system, int channels);
  // After the system's weights have changed.
  void update();
  // z ≈ A⁻¹ r; returns r·z by frame, from the last to the first. Symmetric and positive definite.
  std::vector<RowSums> apply(const Frames& r, Frames* z);

 private:
  void carry_forth(int t, const Field& b, const Field& z, Field* next) const;
  void carry_back(int t, const Field& next, Field* b) const;
  void add_guess(int t, const Field& next, Field* z) const;

  const SpaceTimeSystem& system_;
  std::vector<Multigrid> schur_;      // of B_t + K_t, B_t with what earlier frames leave
  std::vector<WeightPlane> guesses_;  // Θ
  Field solved_;                      // of one frame
};

}  // namespace gradus::reconstruct
