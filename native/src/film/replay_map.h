// Whose random numbers the pixels of a frame take, where they replay those of another one (contract 1.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "film/pixel_correspondence.h"

namespace gradus::film {

struct ReplayMap {
  int32_t stream_frame = 0;            // number of the frame that is replayed
  PixelCorrespondence correspondence;  // by pixels of the region: the pixel of the same region; kNoCorrespondence: a
                                       // stream of its own, tagged as a hole
  uint64_t scene_key = 0;              // of the scene that the replayed frame shows; 0: not known
  uint32_t seed = 0;                   // of the frame that is replayed
  bool shares_jitter = true;           // whether its cells did. Not stored: its scene tells
  // Of components that go their own ways, as reflections do: likewise, by component; empty, or none: `correspondence`.
  std::vector<PixelCorrespondence> of_component{};

  bool has_component_map(int component) const {
    return size_t(component) < of_component.size() && !of_component[size_t(component)].empty();
  }
};

inline bool replays_same(const ReplayMap& a, const ReplayMap& b) {
  return a.correspondence == b.correspondence && a.of_component == b.of_component;
}

}  // namespace gradus::film
