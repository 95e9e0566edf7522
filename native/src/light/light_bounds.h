// Union and cost of light bounds, for building the tree.
#pragma once

#include "light/light_tree.h"

namespace gradus::light {

// Returns bounds that contain both `a` and `b`. Empty bounds (lower above upper) are ignored.
LightBounds unite(const LightBounds& a, const LightBounds& b);
// Returns the cost of a node by the surface area orientation heuristic (Conty Estévez and Kulla 2018, section 4.3):
// area · solid angle of emission · power. `stretch` is the parent's maximum extent divided by its extent along the
// split axis; the factor avoids thin boxes.
float orientation_cost(const LightBounds& b, float stretch);

}  // namespace gradus::light
