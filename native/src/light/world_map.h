// The world's importance map, which is reused from commit to commit.
#pragma once

#include <memory>
#include <vector>

#include "base/commit_monitor.h"
#include "light/environment.h"

namespace gradus::image {
class Image;
}  // namespace gradus::image
namespace gradus::shading {
struct MaterialData;
}  // namespace gradus::shading

namespace gradus::light {

class LitScene;

// The map of a commit and the inputs of its measurement. The next commit reuses the map if no input changed.
struct WorldMap {
  std::shared_ptr<const shading::MaterialData> material;
  std::vector<std::shared_ptr<const image::Image>> images;  // Images that the material uses.
  uint32_t importance = 0;
  uint32_t map_size = 0;
  Environment environment;
};

// Returns the distribution of the world's light, and updates `map` if the world changed. The result is black without a
// world, or if sampling of the world is disabled. A map of automatic size is as wide as the widest image, as in Cycles,
// but at most 1024 cells. Throws Error CANCELLED; `map` is empty afterwards.
Environment build_world(const LitScene& scene, WorldMap* map, const CommitMonitor& monitor);

}  // namespace gradus::light
