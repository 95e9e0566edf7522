// Where the pixels of another frame lie in a picture: pixel correspondences of successive frames, one after another.
// Fractions of a pixel are kept, so that no sample is resampled.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"
#include "film/replay_map.h"
#include "reconstruct/space_time/frame_records.h"

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
// Extends a track of `picture` from frame t to the frame before or after it. `correspondence` leads from the pixels of
// frame t to those of that frame. Where two pixels arrive in one, it holds the one that lies nearer to its centre. What
// lies behind the edge of a nearer surface that moves in another way is left out.
PixelTrack extended(const PixelTrack& track, const film::PixelCorrespondence& correspondence,
                    const FrameRecords& picture);
// Returns the correspondence from the pixels of the frame before to those of frame t. Its off_centre is that of the end
// of a displacement back from the centre of the pixel in frame t.
film::PixelCorrespondence inverse(const film::PixelCorrespondence& to_previous);

}  // namespace gradus::reconstruct
