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

// `here`: the picture's own frame; `regressed`: its picture by its own samples, in units of its scale.
MovedSamples move_samples(const FrameRecords& frame, PixelTrack track, const FrameRecords& here,
                          const Field& regressed);

}  // namespace gradus::reconstruct
