// Samples of several frames, joined: each pixel of a picture holds weighted means over the frames. Light is linear in
// the features, so that the mean light belongs to the mean features, and one regression serves all frames.
#pragma once

#include <functional>
#include <vector>

#include "reconstruct/reconstructed.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/space_time/moved_samples.h"

namespace gradus::reconstruct {

// A frame that contributes to a picture.
struct JoinedFrame {
  int number;
  const FrameRecords* records;
  MovedSamples moved;
};

class JoinedSamples {
 public:
  // `here` is the picture's own frame. It and the samples of the others must outlive the object.
  JoinedSamples(const FrameRecords& here, std::vector<JoinedFrame> others);

  // Returns what the picture's regression reads, in units of the picture. `image` is that of its own frame. `features`
  // receives the features of the pixels to estimate: the means near the centres of pixels, filtered by the noise that
  // the frames show. Their depth is relative (feature_regression.h).
  PictureSamples picture(const HalvedImage& image, film::Features* features) const;
  // Returns the mean light near the centres of pixels, in the units of the film, with these features. `regressed` are
  // the colours of the picture in the same units: light is moved to the centres by what they change up to there.
  SampledPicture sampled(film::Features features, const Field& regressed) const;
  // Returns the means of the terms of all frames with the same weights. Colours are moved as light is, by their own
  // changes; terms of light stay where the samples lie. read(number) returns those of a frame, `own` are those of the
  // picture's own frame. Light without noise stays as it is there. Frames that have another number of terms are left
  // out.
  SampledTerms sampled(SampledTerms own, const std::function<SampledTerms(int number)>& read) const;
  // Joins channels [first, first + the channels of `own`) of a component, or of the sum of all, with `own`, those of
  // the picture's own frame.
  JoinedPlane join(int component, int first, const Field& own) const;

 private:
  const FrameRecords& here_;
  std::vector<JoinedFrame> others_;
};

}  // namespace gradus::reconstruct
