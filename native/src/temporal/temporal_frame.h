// What a space-time reconstruction needs of a frame: its samples, and those that replay the frame before (contract 4.2).
#pragma once

#include <memory>

#include "frame/frame.h"
#include "frame/links.h"

namespace gradus {

// Images of a frame, and half the differences of its halves, which give deviations of all that is linear in the images.
struct HalvedImages {
  GradientImages values, half_differences;
};
// Of its first component.
HalvedImages read_halved(const Frame& frame);

struct TemporalFrame {
  HalvedImages base;
  HalvedImages replay;              // of the random numbers of the frame before; empty in the first of a sequence
  std::vector<float> replay_share;  // of the samples of each pixel
  std::vector<int32_t> links;       // by pixels: that of the next frame, as y·width + x, or kNoLink; empty in the last
  bool is_first() const { return replay.values.primal.empty(); }
};
// replay: nullptr in the first frame of a sequence.
TemporalFrame make_temporal_frame(const Frame& base, const Frame* replay);

}  // namespace gradus
