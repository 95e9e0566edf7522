// A sequence of any length, window by window, with the memory of one.
#pragma once

#include <functional>
#include <memory>

#include "reconstruct/space_time/window_blend.h"
#include "reconstruct/space_time/window_solver.h"

namespace gradus {

// The frames of a window; their size and channels are those of all windows.
using OpenWindow = std::function<std::unique_ptr<WindowSource>(const FrameRange& frames)>;

// The pictures of a window's frames by W of all channels, interleaved; each is made when it is taken.
void reconstruct_window(const WindowSource& source, uint32_t reconstruction, float alpha, const CancelTest& cancel, SolveReport* report,
                        const std::function<void(int t, std::vector<float> image)>& take);

// Takes the frames of a range in order, each when no later window has a share in it. Ends early when cancelled.
void reconstruct_sequence(const FrameRange& range, const OpenWindow& open, uint32_t reconstruction, float alpha, const CancelTest& cancel,
                          SolveReport* report, const WindowBlend::Take& take);

}  // namespace gradus
