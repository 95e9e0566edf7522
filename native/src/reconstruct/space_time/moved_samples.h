// The samples of another frame, moved to the pixels of a picture that show the same surfaces.
#pragma once

#include "reconstruct/field.h"
#include "reconstruct/space_time/frame_records.h"
#include "reconstruct/space_time/pixel_track.h"

namespace gradus::reconstruct {

struct MovedSamples {
  PixelTrack track;
  Field kept;  // share of the samples' weight in each cell that the tests of light and alpha leave (light_test.h)
  Field depth_ratio;  // of the depths in each cell that the picture sees of the same surfaces to those of the frame
};

// The picture that the samples of other frames are compared with.
struct ComparedPicture {
  const FrameRecords& here;  // its own frame
  Field regressed;           // its light by its own samples, in units of its scale
  // Its alpha, smoothed, and how much alpha differs around each pixel; empty if it is opaque.
  Field alpha{}, range_of_alpha{};
};
// `here` must outlive the result.
ComparedPicture compared_picture(const FrameRecords& here, Field regressed);

MovedSamples move_samples(const FrameRecords& frame, PixelTrack track, const ComparedPicture& picture);

}  // namespace gradus::reconstruct
