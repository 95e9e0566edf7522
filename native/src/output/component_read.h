// Reads the passes of light path components.
#pragma once

#include <string>
#include <vector>

#include "film/film.h"

namespace gradus::output {

// Throws invalid_argument if the settings have no component of that name or do not use components at all.
void check_component(const GradusSettings& settings, const std::string& name);
// Fills the pixels of `region` with the background value of the pass, for a component without any path in the film.
void read_absent_component(uint32_t pass, const Region& region, float* pixels);
// Returns whether a pass of a component is computed from two frames by optical flow (animation/component_flows.h). If
// only one frame exists, such a pass holds the motion of the visible surfaces and marks its pixels as not tracked.
bool is_by_flow(const std::string& component, uint32_t pass);
// Writes the pixels of `region`, with the number of channels of the pass. `color` is the component's RGB picture of
// the region; it is only used by passes that derive from it. Throws invalid_operation if the film was sampled without
// the data that the pass needs.
void read_component_pass(const film::Film& film, int component, uint32_t pass, const Region& region,
                         const std::vector<float>& color, float* pixels);

}  // namespace gradus::output
