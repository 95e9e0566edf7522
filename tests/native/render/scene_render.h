// Renders of small scenes, from start to end.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "render/render.h"
#include "support/path_scene.h"

namespace gradus::test {

inline std::unique_ptr<render::Render> started(PathScene* scene, const GradusSettings& settings) {
  return std::make_unique<render::Render>(test_device(), scene->context(settings).snapshot, settings);
}

inline std::unique_ptr<render::Render> rendered(PathScene* scene, const GradusSettings& settings) {
  auto render = started(scene, settings);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_OK) << text;
  return render;
}

inline std::unique_ptr<render::Render> rendered(Scenario scenario, const GradusSettings& settings) {
  PathScene scene;
  build(scenario, &scene);
  return rendered(&scene, settings);
}

}  // namespace gradus::test
