// The pictures of a window by L2 or L1, and what their errors are made of.
#pragma once

#include <functional>

#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/window_solver.h"

namespace gradus::reconstruct {

// The pictures of a window's frames by W of all channels, interleaved; each is made when it is taken. with_error: the
// terms of their errors, too, as of still frames (reconstruct/error_estimate.h): two more solves at most. Nothing is
// taken when cancelled.
void reconstruct_window(const HalvedWindowSource& source, uint32_t reconstruction, float alpha, bool with_error,
                        const CancelCheck& cancel, SolveReport* report,
                        const std::function<void(int t, Reconstructed picture)>& take);

}  // namespace gradus::reconstruct
