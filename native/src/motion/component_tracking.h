// Where what components show through smooth surfaces has gone in the next frame.
#pragma once

#include <vector>

#include "motion/specular_motion.h"

namespace gradus::motion {

// Of the components whose bits are set in `wanted`, in order, by pixels of `from`; NoPath where a component is seen
// directly, or not at all. Cancelled: pixels are NotConverged.
std::vector<ChainMotion> track_components(const CentreView& from, const ChainTracer& to,
                                          const lpe::ComponentSet& components, uint32_t wanted,
                                          const CancelCheck& is_cancelled);
// Whether a component is seen through smooth surfaces anywhere.
bool is_seen_through_smooth(const ChainMotion& motion);

}  // namespace gradus::motion
