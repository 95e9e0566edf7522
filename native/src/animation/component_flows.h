// Motion by optical flow between frames of a sequence (Zimmer et al. 2015, section 4.2): of the light of Residual,
// which no path stands for, and of the irradiance of any component.
#pragma once

#include <array>
#include <vector>

#include "animation/developed_frame.h"
#include "motion/irradiance_motion.h"

namespace gradus::animation {

struct FlowKind {
  size_t component = 0;                                         // its place in the frame
  motion::FlowDomain domain = motion::FlowDomain::Logarithmic;  // of irradiance; Linear: of light
  bool operator==(const FlowKind&) const = default;
};
// What the passes that are asked for are made of.
std::vector<FlowKind> wanted_flows(const film::Film& frame);

// Of a frame to the one before or after it: of each of its kinds by pixels of what is delivered; no pixels: not known.
using FrameFlows = std::vector<motion::PixelMotion>;

enum class Side { Previous, Next };

// From `first` to the frame after it, and back, of the components that both have. Both show the same region.
std::array<FrameFlows, 2> flows_between(const motion::FlowLibrary& library, const DevelopedFrame& first,
                                        const DevelopedFrame& second);
// Where nothing is there to compare it with, or by: the surfaces' motion, and why.
void complete_flows(const DevelopedFrame& frame, Side side, motion::Tracking cause, FrameFlows* flows);

// As passes have it (contract 6.6).
struct FlowPass {
  FlowKind kind;
  std::vector<Vec4> vectors;   // previous − now, now − next
  std::vector<float> tracked;  // 1 where both are; else the first cause
};
std::vector<FlowPass> join_flows(const DevelopedFrame& frame, const FrameFlows& previous, const FrameFlows& next);

}  // namespace gradus::animation
