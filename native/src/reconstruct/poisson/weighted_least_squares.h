// Minimises Σ w_d (x − I)² + Σ w_g (Dx − g)² with a weight for every row, by solving (W_d + Dᵀ W_g D) x = W_d I + Dᵀ
// W_g g.
#pragma once

#include "reconstruct/poisson/conjugate_gradient.h"
#include "reconstruct/poisson/multigrid.h"
#include "reconstruct/solve_report.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {

class WeightedLeastSquares {
 public:
  WeightedLeastSquares(int width, int height, int channels)
      : multigrid_(width, height, channels),
        data_weights_(width, height, 1),
        b_(width, height, channels),
        fields_(width, height, channels) {}

  // Weights of the rows. Fill them, then call update(). The weights of the differences are `right` and `up` of the
  // matrix; those in the last column and row are ignored. A row of weight 0 is absent, and its values may be anything.
  Field& data_weights() { return data_weights_; }
  Stencil& matrix() { return multigrid_.matrix(); }
  void update();

  // Improves x until the goal or `max_steps` is reached.
  CgReport solve(const SolverPlanes& planes, const CgGoal& goal, int max_steps, const CancelCheck& cancel, Field* x);
  // Solves one channel by the frozen weights from `start` and writes it to `out`, at the stride of `planes`. Linear in
  // `planes` to the accuracy of the solve, a relative residual of 1e-6.
  void apply(const PoissonPlanes& planes, const Field& start, float* out) const;

 private:
  Multigrid multigrid_;
  Field data_weights_;
  // Work space, reused from solve to solve.
  Field b_;
  CgFields fields_;
};

// Adds the steps and residual of one solve to the report of a reconstruction.
void add_solve(const CgReport& solve, SolveReport* report);

// Frozen weights, and the minimum for the channels that they were estimated from.
struct Minimum {
  WeightedLeastSquares system;
  Field solution;
};

// Returns the exact L2 solution of interleaved planes, from which the iterations start.
Field start_from_l2(const PoissonPlanes& planes, int width, int height, int channels, float alpha);

}  // namespace gradus::reconstruct
