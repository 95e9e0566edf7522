// The reconstruction REGULARIZED: regression on the features of the film, combined with its sampled differences if it
// has gradients.
#pragma once

#include <functional>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/regression/regression_error.h"
#include "reconstruct/solve_report.h"

namespace gradus::reconstruct {

// Joins channels of a component, or of the sum of all components, with those of the other frames; `first` is the first
// of these channels. `own`: those of the picture's own frame, colours in units of the picture.
using Join = std::function<JoinedPlane(int component, int first, const Field& own)>;

// A picture whose samples are joined with those of other frames.
struct JoinedPicture {
  float scale = 1.0f;  // median luminance
  HalvedImage image;   // of the picture's own frame, in units of `scale`
  PictureSamples samples;
  Join join;
  // All channels of each component of the picture's own frame, from read_sampled(); empty if it has one component and
  // no alpha.
  std::vector<Field> sampled;
  bool by_components = false;  // whether the image of each component is requested
};
inline constexpr int kAllComponents = -1;

// Reconstructs a film and estimates the error. Throws `invalid_operation` if the film has no features. `by_components`
// requests the image of each component. All components go through one operator, that of their sum, so that they add up
// to the image whatever their light. `use` says which error the result has.
Reconstructed regularize(const film::Film& film, bool by_components, const CancelCheck& cancel, SolveReport* report,
                         ErrorUse use = ErrorUse::Weights);
// Reconstructs a picture, and its components if they are requested, by the samples of several frames, with the error
// for delivery. `film` has the differences of its own frame; null if there are none.
Reconstructed regularize(const film::Film* film, JoinedPicture picture, const CancelCheck& cancel, SolveReport* report);

// Reads the sum of all components of a film.
HalvedImage read_sum(const film::Film& film);
// Reads all channels of a component as sampled, colours in units of `scale`. Values that are not finite become 0.
Field read_sampled(const film::Film& film, int component, float scale);

}  // namespace gradus::reconstruct
