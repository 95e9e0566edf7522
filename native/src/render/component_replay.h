// Components that replay other pixels than the surface does, as reflections do (contract 4.2): their samples are taken
// by themselves, where the ways part.
#pragma once

#include <cstdint>
#include <vector>

#include "film/replay_map.h"

namespace gradus::render {

// Along the ways of one component; others that go the same way from a pixel are sampled with it.
struct ComponentReplay {
  film::ReplayMap replay_map;
  std::vector<uint8_t> pixels;       // 1: it is sampled there
  std::vector<uint32_t> components;  // bits of those that are, by pixels
};

struct ComponentReplays {
  std::vector<ComponentReplay> own;
  std::vector<uint32_t>
      shared;           // bits of the components that go with the surface, by pixels; empty: all of them, everywhere
  uint64_t pixels = 0;  // that are sampled once more, for some components or others
};

// Pixels are sampled no more than once again on average: a component beyond that goes with the surface after all.
void limit_component_replays(film::ReplayMap* replay_map);
// By sources.of_component. A component without a way stays with the surface, whose samples are as good as others.
ComponentReplays replays_of_components(const film::ReplayMap& replay_map);

}  // namespace gradus::render
