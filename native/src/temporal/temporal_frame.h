// What a space-time reconstruction needs of a frame: its samples, and those that replay the frame before (contract 4.2).
#pragma once

#include <functional>
#include <memory>
#include <vector>

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
  HalvedImages replay;              // of the random numbers of the frame before
  std::vector<float> replay_share;  // of the samples of each pixel
  std::vector<int32_t> links;       // by pixels: that of the next frame, as y·width + x, or kNoLink; empty in the last
  bool repeats = false;             // it has the samples of the frame before, for nothing has changed
};
// Without links.
TemporalFrame make_temporal_frame(const Frame& base, const Frame& replay);

// The parts of a frame, by its place; held no longer than the frame is made.
using LoadPart = std::function<std::shared_ptr<const Frame>(int place)>;
// Takes frames in order, each with the next one, nullptr after the last: links are those that the replay of the next has followed. No more
// than two are held at a time.
using TakeFrame = std::function<void(std::shared_ptr<const TemporalFrame> frame, const std::shared_ptr<const TemporalFrame>& next)>;
void for_temporal_frames(int count, const LoadPart& base, const LoadPart& replay, const TakeFrame& take);

}  // namespace gradus
