// The world's importance map, from commit to commit.
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

// The map of a commit, and all that it was measured from: the next one keeps it where none of that changed.
struct WorldMap {
  std::shared_ptr<const shading::MaterialData> material;
  std::vector<std::shared_ptr<const image::Image>> images;  // that the material looks up
  uint32_t importance = 0;
  uint32_t map_size = 0;
  Environment environment;
};

// Measures the world's radiance, if it differs from that of `map`; black without a world, or where it is not to be
// sampled. An automatic map is as wide as the largest image, as in Cycles, but at most 1024 cells. Throws Error
// CANCELLED, and then `map` is empty.
Environment build_world(const LitScene& scene, WorldMap* map, const CommitMonitor& monitor);

}  // namespace gradus::light
