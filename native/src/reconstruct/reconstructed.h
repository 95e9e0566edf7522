#pragma once

#include <vector>

namespace gradus::reconstruct {

// What the estimate of a squared error is made of (reconstruct/error_estimate.h), images of values that have signs:
// terms of parts add up to those of their sum, as errors do not. One pixel's squares say little: their sums over a cell
// or a window do.
struct ErrorTerms {
  std::vector<float> noise;  // what the reconstruction, or L2 in its place, makes of half the difference of the halves
  std::vector<float> apart;  // distance of the image from L2's; empty where the reconstruction is linear
};

// What a frame, or a component of one, becomes: its picture, and what is known of the picture's error.
struct Reconstructed {
  std::vector<float> image;  // width·height·channels
  std::vector<float>
      error;  // width·height: estimated squared error of the image, mean over RGB; empty unless asked for
  std::vector<std::vector<float>> components{};  // images that add up to it; none unless asked for
  ErrorTerms terms{};                            // of RGB, of pictures by L2 or L1 over time: in the place of the error
};

}  // namespace gradus::reconstruct
