// L2 reconstruction: exact, of an image whose rows are made on demand, or by iteration where differences are missing.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "reconstruct/poisson/solver.h"

namespace gradus::reconstruct {

// One row of the planes, with interleaved channels. `dy_below` is dy of the row below; unused for row 0.
struct L2Row {
  const float *primal, *dx, *dy, *dy_below;
};
using L2Use = std::function<void(const L2Row& row)>;
// Calls use(row y). Called from several threads, once for each row.
using L2Rows = std::function<void(int y, const L2Use& use)>;

// Receives row y of the solution, one channel after another. Called from several threads, once for each row.
using L2Take = std::function<void(int y, const float* row)>;

// Returns the rows of the first `channels` channels of planes in memory. The planes must outlive the result.
L2Rows rows_of(const PoissonPlanes& planes, int width, int channels);

// Minimises α²‖x−I‖² + ‖Dx−g‖² exactly by DCT (thesis eq. 5.13 with k = 2; Bhat et al. 2008 for the DCT). It is linear
// in its input, hence unbiased if the gradients are. Solves all channels at once, 1 to 4; each has the same bits as
// alone. `work` holds width·height·channels floats; `take` may overwrite its row y. Returns false if values are
// missing: these counted as 0, and the caller should use solve_l2_with_gaps() instead. Throws `unsupported` for other
// numbers of channels.
bool solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows, const L2Take& take, float* work);
// Returns the solution as an image with interleaved channels, or nothing if values are missing.
std::optional<std::vector<float>> solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows);

// Minimises the same sum over the rows that exist, by multigrid. It is unbiased if the samples do not decide which rows
// exist. Missing values are not finite. Returns width·height·channels values.
std::vector<float> solve_l2_with_gaps(const film::GradientImages& images, float alpha, const CancelCheck& cancel,
                                      SolveReport* report);

}  // namespace gradus::reconstruct
