// Replays of single components. A component such as a reflection may move over the image differently from the surface
// that shows it, and then replays the samples of other pixels of the previous frame than the surface does. Where the
// two differ, the samples of the component are taken in an additional pass.
#pragma once

#include <cstdint>
#include <vector>

#include "film/replay_map.h"

namespace gradus::render {

// The replay of one component. Other components with the same source pixel are sampled with it.
struct ComponentReplay {
  film::ReplayMap replay_map;
  std::vector<uint8_t> pixels;       // 1 where this replay samples the pixel
  std::vector<uint32_t> components;  // by pixel: bits of the components that are sampled
};

struct ComponentReplays {
  std::vector<ComponentReplay> own;
  // By pixel: bits of the components that are replayed with the surface. Empty: all components in all pixels.
  std::vector<uint32_t> shared;
  uint64_t pixels = 0;  // number of additional pixel replays, summed over `own`
};

// Removes component maps until at most as many additional pixels are sampled as the film has. A component beyond that
// limit is replayed with the surface.
void limit_component_replays(film::ReplayMap* replay_map);
// Returns the replays by replay_map.of_component. A component without a source pixel is replayed with the surface.
ComponentReplays replays_of_components(const film::ReplayMap& replay_map);

}  // namespace gradus::render
