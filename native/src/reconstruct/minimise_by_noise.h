// Minimises Σ (x − I)²/s_I² + Σ (Dx − g)²/s_g² with the measured noise s of every row: where differences are noisy,
// pixels count more, and the other way round. Consistent: the weights tend to constants as samples are added.
#pragma once

#include "reconstruct/weighted_least_squares.h"

namespace gradus::reconstruct {

// Estimates the weights from the deviations of `images` (read_deviations()) and freezes them.
Minimum minimise_by_noise(const film::GradientImages& images, const CancelCheck& cancel, SolveReport* report);

// Weights of pixels and of differences by noise (noise_weights.h). A wider window measures better, but leaves outliers
// in, which the own deviation finds out: of 0.5 to 4 pixels this gives the least error (docs/method.md). A row that is
// missing has weight 0. unknown: deviation of pixels whose noise is not known, in units of the scale.
void weigh_pixels_by_noise(const film::GradientImages& images, float scale, float unknown, Field* data);
void weigh_differences_by_noise(const film::GradientImages& images, float scale, float unknown, Stencil* matrix);

// Of differences that are known far better than their pixels, so that the system stays one that can be solved.
void limit_differences(const Field& data, Stencil* matrix);

// Solves with such weights, from x on, as exactly as the noise asks for.
void solve_by_noise(const SolverPlanes& planes, const CancelCheck& cancel, WeightedLeastSquares* system, Field* x,
                    SolveReport* report);

}  // namespace gradus::reconstruct
