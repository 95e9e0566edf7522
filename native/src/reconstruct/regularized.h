// The reconstruction REGULARIZED: regression on the features of the film, combined with its sampled differences if it
// has gradients.
#pragma once

#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "film/features.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/regression/regression_error.h"
#include "reconstruct/solve_report.h"

namespace gradus::reconstruct {

// Frames that contribute to the picture of another one.
struct OtherFrames {
  std::vector<MovedFrame> frames;
  // What the films of these frames hold, by frame and component, moved like their samples: colours in the units of the
  // moved images, alpha. Read if the picture has alpha or several components.
  std::vector<std::vector<Field>> sampled;
  std::shared_ptr<const Field> features;  // of the picture's pixels, from the samples of all frames
};

// Reconstructs a film and estimates the error. Throws `invalid_operation` if the film has no features. `by_components`
// requests the image of each component. All components go through one operator, that of their sum, so that they add up
// to the image whatever their light. `use` says which error the result has.
Reconstructed regularize(const film::Film& film, bool by_components, const CancelCheck& cancel, SolveReport* report,
                         ErrorUse use = ErrorUse::Weights);
// Reconstructs a film by its features, from regression_features(), and other frames.
Reconstructed regularize(const film::Film& film, Field features, const OtherFrames& others, bool by_components,
                         const CancelCheck& cancel, SolveReport* report, ErrorUse use = ErrorUse::Weights);

// Reads the sum of all components of a film.
HalvedImage read_sum(const film::Film& film);
// Reads all channels of a component as sampled, colours in units of `scale`. Values that are not finite become 0.
Field read_sampled(const film::Film& film, int component, float scale);

}  // namespace gradus::reconstruct
