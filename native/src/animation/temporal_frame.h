// The images of a frame that a space-time reconstruction reads: those of its fresh samples, and those of the samples
// that replay the previous frame.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "base/fault.h"
#include "film/film.h"
#include "film/replay_map.h"

namespace gradus::animation {

// Loads samples of the frame at a place of a sequence. Throws Error CANCELLED.
using LoadSamples = std::function<std::shared_ptr<film::Film>(int place, const CancelCheck& cancel)>;

// The images to make of a frame, besides its pixels.
struct TemporalContent {
  bool gradients = true;  // spatial differences, if the frame has them
  bool halves = true;     // (A − B)/2 of the half-buffers
};

// Images of a frame, and (A − B)/2 of its half-buffers. The latter give the standard deviation of any image that is
// linear in the former.
struct HalvedImages {
  film::GradientImages values, half_differences;
};

struct TemporalFrame {
  HalvedImages fresh;
  HalvedImages replay;              // samples that replay the random numbers of the previous frame
  std::vector<float> replay_share;  // share of the replayed samples in the samples of each pixel, 0 to 1
  int32_t stream = 0;               // frame whose random numbers the fresh samples use
  uint64_t scene_key = 0;           // key of the scene that both show
  film::ReplayMap replayed;         // frame and pixels whose random numbers the replayed samples use
};

// Makes the images of all components together, or of one component with its own replay map. Throws invalid_argument if
// `fresh` and `replay` differ in size or planes.
inline constexpr int kAllComponents = -1;
TemporalFrame make_temporal_frame(const film::Film& fresh, const film::Film& replay, TemporalContent content = {},
                                  int component = kAllComponents);
// make_fresh() makes only what the temporal differences from this frame to the next one read, make_replay() only what
// those from the previous frame to this one read.
TemporalFrame make_fresh(const film::Film& fresh, TemporalContent content);
TemporalFrame make_replay(const film::Film& replay, int32_t stream, TemporalContent content);

// Throws invalid_argument, with the number of the frame, if the images differ in size or planes: a folder may hold
// files of other renders under the names of frames.
void check_same_layout(const film::GradientImages& images, const film::GradientImages& other, int32_t frame);

// Whether the next frame has the same samples as this one, because nothing has changed between them. Frames of
// different scenes never share samples.
inline bool is_repeated(const TemporalFrame& frame, const TemporalFrame& next) {
  return next.stream == frame.stream && next.scene_key == frame.scene_key &&
         !GRADUS_FAULT(unchanged_frame_not_repeated);
}
// Returns for each pixel of the frame the corresponding pixel of the next one, as y·width + x. It inverts the replay
// map of the next frame.
film::PixelCorrespondence correspondence_between(const TemporalFrame& frame, const TemporalFrame& next);

}  // namespace gradus::animation
