// Whose random numbers the pixels of a frame take, where they replay those of another one (contract 1.1).
#pragma once

#include <cstdint>
#include <vector>

#include "frame/links.h"

namespace gradus {

struct SampleSources {
  int32_t stream_frame = 0;    // number of the frame that is replayed
  std::vector<int32_t> pixel;  // by pixels of the region: the pixel of the same region; kNoLink: a stream of its own, tagged as a hole
  uint64_t scene_key = 0;      // of the scene that the replayed frame shows; 0: not known
  uint32_t seed = 0;           // of the frame that is replayed
  bool shares_jitter = true;   // whether its cells did. Not stored: its scene tells
};

}  // namespace gradus
