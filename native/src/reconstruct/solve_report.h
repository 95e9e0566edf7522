// What a reconstruction reports of the iterations that solve its linear equations.
#pragma once

namespace gradus::reconstruct {

struct SolveReport {
  int outer_steps = 0;
  int inner_steps = 0;
  float residual = 0.0f;  // norm of the residual over that of the right side; maximum over all solves
  bool hit_cap = false;   // whether a solve ended at its maximum number of steps before it converged
};

}  // namespace gradus::reconstruct
