// Combined from a frame: the sum of the components, each by its own solver (contract 3.4).
#pragma once

#include <vector>

#include "frame/frame.h"
#include "reconstruct/solver.h"

namespace gradus {

// RGBA of `region`, with the film's exposure. reconstruction: never AUTO. L2 may be negative (contract 5.5), the others not; alpha lies in
// [0, 1].
std::vector<float> combine(const Frame& frame, uint32_t reconstruction, float alpha, const Region& region, const CancelTest& cancel,
                           SolveReport* report);

}  // namespace gradus
