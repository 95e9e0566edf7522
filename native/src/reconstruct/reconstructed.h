#pragma once

#include <vector>

namespace gradus {

// What a frame, or a component of one, becomes: its picture, and what is known of the picture's error.
struct Reconstructed {
  std::vector<float> image;  // width·height·channels
  std::vector<float> error;  // width·height: estimated squared error of the image, mean over RGB; empty unless asked for
  std::vector<std::vector<float>> components{};  // images that add up to it; none unless asked for
};

}  // namespace gradus
