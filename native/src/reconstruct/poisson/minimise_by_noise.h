// Minimises Σ (x − I)²/s_I² + Σ (Dx − g)²/s_g² with the measured noise s of every row: where differences are noisy,
// pixels count more, and vice versa. The result is consistent, because the weights tend to constants as samples are
// added.
#pragma once

#include "reconstruct/poisson/weighted_least_squares.h"

namespace gradus::reconstruct {

// Estimates the weights from the deviations of `images` (film::read_deviations()) and freezes them.
Minimum minimise_by_noise(const film::GradientImages& images, const CancelCheck& cancel, SolveReport* report);

// Compute the weights of pixels and of differences from their noise (noise_weights.h), in units of `scale`. `unknown`
// is the deviation of pixels whose noise is not known, in the same units. A missing row has weight 0. The window of
// noise_weights.h, of 0.5 to 4 pixels, has the least error (measured): a wider one estimates deviations better, but
// misses outliers, which a row's own deviation shows.
void weigh_pixels_by_noise(const film::GradientImages& images, float scale, float unknown, Field* data);
void weigh_differences_by_noise(const film::GradientImages& images, float scale, float unknown, Stencil* matrix);

// Limits the weights of differences that are known far better than their pixels, so that the system remains solvable in
// single precision (noise_weights.h).
void limit_differences(const Field& data, Stencil* matrix);

// Solves the system from x on, to an accuracy well below the noise, and adds the solve to `report`.
void solve_by_noise(const SolverPlanes& planes, const CancelCheck& cancel, WeightedLeastSquares* system, Field* x,
                    SolveReport* report);

}  // namespace gradus::reconstruct
