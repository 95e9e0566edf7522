// Minimises Σ w_d (x − I)² + Σ w_g (Dx − g)² for weights of every row: (W_d + Dᵀ W_g D) x = W_d I + Dᵀ W_g g.
#pragma once

#include "reconstruct/conjugate_gradient.h"
#include "reconstruct/multigrid.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {

class WeightedLeastSquares {
 public:
  WeightedLeastSquares(int width, int height, int channels)
      : multigrid_(width, height, channels),
        data_weights_(width, height, 1),
        b_(width, height, channels),
        fields_(width, height, channels) {}

  // To be filled, then update(). Those of the differences are the matrix's `right` and `up`; in the last column and
  // row, which carry none, they may be anything. A row of weight 0 is absent; its values may be anything.
  Field& data_weights() { return data_weights_; }
  Stencil& matrix() { return multigrid_.matrix(); }
  void update();

  // Improves x.
  CgReport solve(const SolverPlanes& planes, const CgGoal& goal, int max_steps, const CancelCheck& cancel, Field* x);
  // One channel by the frozen weights, from `start` on: linear in `planes` as far as it is solved, which is to 1e-6.
  void apply(const PoissonPlanes& planes, const Field& start, float* out) const;

 private:
  Multigrid multigrid_;
  Field data_weights_;
  // Work space, kept from solve to solve.
  Field b_;
  CgFields fields_;
};

// Adds a solve to what is reported of a reconstruction.
void add_solve(const CgReport& solve, SolveReport* report);

// Weights, and the minimum for the channels that they were estimated from.
struct Minimum {
  WeightedLeastSquares system;
  Field solution;
};

// The exact L2 solution of interleaved planes: where the iterations start.
Field start_from_l2(const PoissonPlanes& planes, int width, int height, int channels, float alpha);

}  // namespace gradus::reconstruct
