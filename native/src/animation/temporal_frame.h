// What a space-time reconstruction needs of a frame: its samples, and those that replay the frame before
// (contract 4.2).
#pragma once

#include <vector>

#include "film/film.h"
#include "film/pixel_correspondence.h"

namespace gradus::animation {

// What is made of a frame, besides its pixels.
struct TemporalContent {
  bool gradients = true;  // where the frame has them
  bool halves = true;     // half the differences of the halves
};

// Images of a frame, and half the differences of its halves, which give deviations of all that is linear in the images.
struct HalvedImages {
  film::GradientImages values, half_differences;
};

struct TemporalFrame {
  HalvedImages fresh;
  HalvedImages replay;              // of the random numbers of the frame before
  std::vector<float> replay_share;  // of the samples of each pixel
  int32_t stream = 0;               // whose random numbers the base has taken
  uint64_t scene_key = 0;           // of the scene that both show
  film::ReplayMap replayed;         // and whose the replay has
};

// Of all their components together, or of one, with what it has replayed. Throws invalid_argument where the two do not
// belong together.
inline constexpr int kAllComponents = -1;
TemporalFrame make_temporal_frame(const film::Film& fresh, const film::Film& replay, TemporalContent content = {},
                                  int component = kAllComponents);
// Of one of the two: all that differences over time from the frame to the next, or to the frame from the one before,
// read of it.
TemporalFrame make_fresh(const film::Film& fresh, TemporalContent content);
TemporalFrame make_replay(const film::Film& replay, int32_t stream, TemporalContent content);

// Throws invalid_argument where the images differ in size or kinds: whatever a folder may hold under the names of
// frames.
void check_same_layout(const film::GradientImages& images, const film::GradientImages& other, int32_t frame);

// The next frame has the samples of this one, for nothing has changed. Of one that was stored of an older scene it has
// none.
inline bool is_repeated(const TemporalFrame& frame, const TemporalFrame& next) {
  return next.stream == frame.stream && next.scene_key == frame.scene_key;
}
// By pixels of the frame: that of the next one, as y·width + x: those that the replay of the next has followed.
film::PixelCorrespondence correspondence_between(const TemporalFrame& frame, const TemporalFrame& next);

}  // namespace gradus::animation
