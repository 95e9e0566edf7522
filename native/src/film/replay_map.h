// The replay map of a frame: for each pixel, the pixel of another frame whose random numbers it replays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "film/pixel_correspondence.h"

namespace gradus::film {

struct ReplayMap {
  int32_t stream_frame = 0;  // number of the replayed frame
  // Replayed pixel of the same region for each pixel; kNoCorrespondence marks a disocclusion, which has its own stream.
  PixelCorrespondence correspondence;
  uint64_t scene_key = 0;     // scene key of the replayed frame; 0 if unknown
  uint32_t seed = 0;          // seed of the replayed frame
  bool shares_jitter = true;  // pixel blocks of the replayed frame share jitter; not stored, derived from its scene
  // Maps of components whose film displacement differs, such as reflections. A component without a map, or with an
  // empty one, uses `correspondence`.
  std::vector<PixelCorrespondence> of_component{};

  bool has_component_map(int component) const {
    return size_t(component) < of_component.size() && !of_component[size_t(component)].empty();
  }
};

inline bool replays_same(const ReplayMap& a, const ReplayMap& b) {
  return a.correspondence == b.correspondence && a.of_component == b.of_component;
}

}  // namespace gradus::film
