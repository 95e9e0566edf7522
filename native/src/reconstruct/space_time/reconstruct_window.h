// Reconstruction of the frames of a window by L2 or L1, with the terms of their errors.
#pragma once

#include <functional>

#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/window_solver.h"

namespace gradus::reconstruct {

// Reconstructs all frames of a window by one operator and passes each image, with interleaved channels, to take(). An
// image is made just before it is passed, so that the window's images are not in memory together. `with_error` adds the
// terms of the error, as for single frames (reconstruct/error_estimate.h), which takes at most two more solves. When
// cancelled, take() is not called.
void reconstruct_window(const HalvedWindowSource& source, uint32_t reconstruction, float alpha, bool with_error,
                        const CancelCheck& cancel, SolveReport* report,
                        const std::function<void(int t, Reconstructed picture)>& take);

}  // namespace gradus::reconstruct
