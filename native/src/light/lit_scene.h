// The scene data that light sampling needs: shaded geometry and the table of all emitters.
#pragma once

#include <memory>

#include "shading/shaded_scene.h"

namespace gradus::light {

struct LightTable;  // See light/light_table.h.

// A shaded scene with its emitters. It is the base class of a snapshot that functions for light sampling take.
class LitScene : public shading::ShadedScene {
 public:
  std::shared_ptr<const LightTable> light_table;
};

}  // namespace gradus::light
