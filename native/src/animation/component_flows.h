// Motion by optical flow between frames of a sequence (Zimmer et al. 2015, section 4.2). It is estimated from the
// radiance of the component Residual, for which no representative path exists, and from the irradiance of any
// component.
#pragma once

#include <array>
#include <vector>

#include "animation/developed_frame.h"
#include "motion/irradiance_motion.h"

namespace gradus::animation {

// A flow that a frame needs: which component, and on which quantity the flow is estimated.
struct FlowKind {
  size_t component = 0;                                         // index in Film::components
  motion::FlowDomain domain = motion::FlowDomain::Logarithmic;  // Logarithmic: of irradiance; Linear: of radiance
  bool operator==(const FlowKind&) const = default;
};
// Returns the flows that the requested component passes of the film need, in the order of its components.
std::vector<FlowKind> wanted_flows(const film::Film& frame);

// Flows of a frame to the frame before or after it: one for each of its wanted_flows(), with one entry for each
// delivered pixel. A flow without pixels is not known.
using FrameFlows = std::vector<motion::PixelMotion>;

// The neighbouring frame to which a flow leads.
enum class Side { Previous, Next };

// Estimates the flows from `first` to the frame `second` after it, and from `second` back to `first`, of the components
// that both frames have. Both frames must show the same region.
std::array<FrameFlows, 2> flows_between(const motion::FlowLibrary& library, const DevelopedFrame& first,
                                        const DevelopedFrame& second);
// Fills in the flows that are not known with the motion of the surfaces. Their pixels are not tracked, for `cause`.
void complete_flows(const DevelopedFrame& frame, Side side, motion::Tracking cause, FrameFlows* flows);

// A flow as passes have it: (previous − now, now − next) in pixels, y up.
struct FlowPass {
  FlowKind kind;
  std::vector<Vec4> vectors;
  std::vector<float> tracked;  // 1 where both flows are tracked, otherwise the first cause why not
};
// Joins the flows to the previous and to the next frame into passes.
std::vector<FlowPass> join_flows(const DevelopedFrame& frame, const FrameFlows& previous, const FrameFlows& next);

}  // namespace gradus::animation
