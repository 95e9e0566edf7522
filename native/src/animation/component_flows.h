// Motion by optical flow between frames of a sequence (Zimmer et al. 2015, section 4.2). It is estimated from the
// radiance of the component Residual, for which no representative path exists, and from the irradiance of any
// component.
#pragma once

#include <array>
#include <vector>

#include "motion/irradiance_motion.h"
#include "output/developed_film.h"

namespace gradus::animation {

// A flow that a frame needs: which component, and on which quantity the flow is estimated.
struct FlowKind {
  size_t component = 0;                                         // index in Film::components
  motion::FlowDomain domain = motion::FlowDomain::Logarithmic;  // Logarithmic: of irradiance; Linear: of radiance
  bool operator==(const FlowKind&) const = default;
};
// Returns the flows that the requested component passes of the film need, in the order of its components.
std::vector<FlowKind> wanted_flows(const film::Film& film);

// Flows of a frame to the frame before or after it: one for each of its wanted_flows(), with one entry for each
// delivered pixel. A flow without pixels is not known.
using FrameFlows = std::vector<motion::PixelMotion>;

// The neighbouring frame to which a flow leads.
enum class Side { Previous, Next };

// Estimates the flows from `first` to the frame `second` after it, and from `second` back to `first`, of the components
// that both frames have. Both frames must show the same region.
std::array<FrameFlows, 2> flows_between(const motion::FlowLibrary& library, const output::DevelopedFilm& first,
                                        const output::DevelopedFilm& second);
// Fills in the flows that are not known with the motion of the surfaces. Their pixels are not tracked, for `cause`.
void complete_flows(const output::DevelopedFilm& frame, Side side, motion::Tracking cause, FrameFlows* flows);

// Joins the flows to the previous and to the next frame into the motion passes of the frame's components: vectors
// (previous − now, now − next) in pixels, y up, and 1 where both flows are tracked, otherwise the first cause why not.
void store_flows(const FrameFlows& previous, const FrameFlows& next, output::DevelopedFilm* frame);

}  // namespace gradus::animation
