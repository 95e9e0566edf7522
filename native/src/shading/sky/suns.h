// Where in the world the suns of its Sky Textures stand.
#pragma once

#include <vector>

#include "shading/graph.h"
#include "shading/sky/sky.h"

namespace gradus::shading {

struct Suns {
  std::vector<SunDisc> discs;
  // Half the angle of the smallest sun whose place could not be told, because something but a rotation turns its sky;
  // 0: there is none.
  float smallest_hidden = 0.0f;
};

Suns find_suns(const Graph& graph);

}  // namespace gradus::shading
