// Where the pixels of another frame lie in a picture: pixel correspondences of successive frames, one after another.
// Fractions of a pixel are kept, so that no sample is resampled.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"
#include "film/replay_map.h"

namespace gradus::reconstruct {

// For each pixel of the picture the pixel of the other frame that lies in it, and where: its centre, relative to the
// centre of the picture's pixel, in [-0.5, 0.5] pixels per axis.
struct PixelTrack {
  int width = 0, height = 0;
  std::vector<int32_t> source;  // kNoCorrespondence: none
  std::vector<Vec2> displacement;
};

// Returns the track of the picture's own pixels.
PixelTrack own_pixels(int width, int height);
// Moves the pixels of a track one frame on in time, to frame t, or one frame back, from frame t. `to_previous` is the
// correspondence between the pixels of frame t and those of the frame before. Where two pixels arrive in one, it holds
// the one that lies nearer to its centre.
PixelTrack moved_on(const PixelTrack& track, const film::PixelCorrespondence& to_previous);
PixelTrack moved_back(const PixelTrack& track, const film::PixelCorrespondence& to_previous);

}  // namespace gradus::reconstruct
