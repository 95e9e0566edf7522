// Directions of the suns in the Sky Textures of a world.
#pragma once

#include <vector>

#include "shading/graph.h"
#include "shading/sky/sky.h"

namespace gradus::shading {

struct Suns {
  std::vector<SunDisc> discs;
  // Half angle of the smallest sun whose direction is unknown, because its texture coordinates are not a rotation of
  // the direction; 0 if there is none.
  float smallest_hidden = 0.0f;
};

// Finds the suns of all Sky Textures of a graph.
Suns find_suns(const Graph& graph);

}  // namespace gradus::shading
