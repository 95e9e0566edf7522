// The preconditioner of a window's system: A ≈ (S + C) S⁻¹ (S + Cᵀ), block elimination from the first frame to the last, with
// one multigrid cycle per frame for S⁻¹.
//
// Eliminating frame t leaves of its matrix B and the coupling K to the next frame their parallel sum B − B (B + K)⁻¹ B, carried along the
// links: conductances in series (Anderson and Duffin 1969). Of two screened Laplacians that is nearly a screened Laplacian again, whose
// screens and edges are the parallel sums ab/(a + b) of theirs: exact for what is smooth and for what is rough, and otherwise less than the
// true one by up to 3 % where all weights are alike. So every pixel and every edge is a ladder of its own along its track.
#pragma once

#include <memory>

#include "reconstruct/multigrid.h"
#include "reconstruct/space_time/system.h"

namespace gradus {

class TimeLadder {
 public:
  TimeLadder(const SpaceTimeSystem& system, int channels);
  // After the system's weights have changed.
  void update();
  // z ≈ A⁻¹ r; returns r·z by frame. Symmetric and positive definite.
  std::vector<RowSums> apply(const Frames& r, Frames* z);

 private:
  const SpaceTimeSystem& system_;
  std::vector<Multigrid> schur_;  // of B_t + K_t, B_t with what earlier frames leave
  Field solved_;                  // of one frame
};

}  // namespace gradus
