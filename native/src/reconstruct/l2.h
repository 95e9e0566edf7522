// The exact L2 solution of an image whose rows are made as they are needed.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// One row of the planes, channels interleaved, and of dy the row below, which the first row has not.
struct L2Row {
  const float *primal, *dx, *dy, *dy_below;
};
using L2Use = std::function<void(const L2Row& row)>;
// Lets `use` see row y; called from several threads, each row once.
using L2Rows = std::function<void(int y, const L2Use& use)>;

// Takes row y of the solution, one channel after another; likewise.
using L2Take = std::function<void(int y, const float* row)>;

// Rows of the first channels of planes that are there.
L2Rows rows_of(const PoissonPlanes& planes, int width, int channels);

// All channels at once; each has the bits that make_l2() gives. work: width·height·channels floats; `take` may write
// its row y. False: values are missing, which asks for weights; they counted as none.
bool solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows, const L2Take& take, float* work);
// The same as an image with interleaved channels; nothing where values are missing.
std::optional<std::vector<float>> solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows);

}  // namespace gradus::reconstruct
