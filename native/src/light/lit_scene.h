// What light sampling needs of a scene: shaded geometry and the table of all emitters.
#pragma once

#include <memory>

#include "shading/shaded_scene.h"

namespace gradus::light {

struct LightTable;  // light/light_table.h: analytic lights, emissive triangles, environment distribution, their choice

// A shaded scene with its emitters. Functions that sample or evaluate light take this part of a snapshot.
class LitScene : public shading::ShadedScene {
 public:
  std::shared_ptr<const LightTable> light_table;
};

}  // namespace gradus::light
