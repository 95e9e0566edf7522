// Passes of components (contract 6.6).
#pragma once

#include <string>
#include <vector>

#include "film/film.h"

namespace gradus::output {

// Throws invalid_argument: the settings have no component of that name.
void check_component(const GradusSettings& settings, const std::string& name);
// Of one that no path of the frame belongs to.
void read_absent_component(uint32_t pass, const Region& region, float* pixels);
// Whether a pass of a component is made of two frames by optical flow (animation/component_flows.h). Of one frame alone
// it is the motion of what the component shows, not tracked.
bool is_by_flow(const std::string& component, uint32_t pass);
// Pixels of `region`. color: the component's picture there, RGB, where the pass is made of it. Throws invalid_operation
// if the frame was sampled without what the pass is made of.
void read_component_pass(const film::Film& film, int component, uint32_t pass, const Region& region,
                         const std::vector<float>& color, float* pixels);

}  // namespace gradus::output
