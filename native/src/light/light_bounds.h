// Union and cost of light bounds, for building the tree.
#pragma once

#include "light/light_tree.h"

namespace gradus::light {

LightBounds unite(const LightBounds& a, const LightBounds& b);
// Surface area orientation heuristic (Conty Estévez and Kulla 2018, section 4.3): area · solid angle of emission ·
// power. stretch: extent of the parent over the extent along the split axis, against thin boxes.
float orientation_cost(const LightBounds& b, float stretch);

}  // namespace gradus::light
