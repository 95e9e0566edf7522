// The replay map of a frame: for each pixel, the pixel of another frame whose random numbers it replays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::film {

// Marks a pixel without a correspondence.
inline constexpr int32_t kNoCorrespondence = -1;

// Maps pixels of one frame to pixels of another one; empty if no pixel has a correspondence.
struct PixelCorrespondence {
  std::vector<int32_t> pixel;  // pixel index in the other frame, or kNoCorrespondence
  // End of the film displacement from the earlier frame, relative to the centre of the pixel in the later frame, in
  // [-0.5, 0.5] pixels per axis. Indexed like `pixel`; empty if all displacements end at pixel centres.
  std::vector<Vec2> off_centre{};

  bool empty() const { return pixel.empty(); }
  bool operator==(const PixelCorrespondence&) const = default;
};

struct ReplayMap {
  int32_t stream_frame = 0;  // number of the replayed frame
  // Replayed pixel of the same region for each pixel; kNoCorrespondence marks a disocclusion, which has its own stream.
  PixelCorrespondence correspondence;
  uint64_t scene_key = 0;     // scene key of the replayed frame; 0 if unknown
  uint32_t seed = 0;          // seed of the replayed frame
  bool shares_jitter = true;  // pixel blocks of the replayed frame share jitter; not stored, derived from its scene
  uint32_t net_samples = 0;   // of the replayed film; 0 if the map is for correspondences alone
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
