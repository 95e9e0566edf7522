#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "reconstruct/regression/halved_image.h"

namespace gradus::reconstruct {

// Terms of the estimate of a squared error (reconstruct/error_estimate.h). They are images of signed values, so the
// terms of components add up to the terms of their sum, which squared errors do not. The square of one pixel is a poor
// estimate; use sums over a pixel block or a window.
struct ErrorTerms {
  // The reconstruction, or L2 in its place, of half the difference of the two half-buffers.
  std::vector<float> noise;
  std::vector<float> l2_difference;  // the image minus the one by L2; empty if the reconstruction is linear
};

// What several frames have sampled of the pixels of a picture, joined: light, moved to the centres of pixels, and
// features, 3 values per pixel each. A denoiser reads it.
struct SampledPicture {
  std::vector<float> light, albedo, normal;
};

// Sampled terms of a picture, such as light passes, and the colours by which they are divided, three channels each.
struct SampledTerms {
  std::vector<HalvedImage> light;
  std::vector<Field> colors;
};
// Reads the terms of a film, as many for all frames of an animation.
using ReadTerms = std::function<SampledTerms(const film::Film& film)>;

// What a picture of several frames returns beside itself.
struct JoinedOutputs {
  bool components = false;    // Reconstructed::components
  bool sampled = false;       // Reconstructed::sampled
  ReadTerms terms = nullptr;  // Reconstructed::sampled_terms, unless it is empty
};

// Result of the reconstruction of a film or of one of its components.
struct Reconstructed {
  std::vector<float> image;  // width·height·channels
  std::vector<float> error;  // width·height: estimated squared error, mean over RGB; empty unless requested
  std::vector<std::vector<float>> components{};     // images that add up to `image`; empty unless requested
  std::shared_ptr<const SampledPicture> sampled{};  // null unless requested, or if no frames are joined
  // Terms of `sampled`, as JoinedOutputs::terms reads them; null unless requested, or if no frames are joined.
  std::shared_ptr<const SampledTerms> sampled_terms{};
  ErrorTerms terms{};  // RGB; replaces `error` for images that L2 or L1 reconstructs over several frames
};

}  // namespace gradus::reconstruct
