// The pictures of the regression test: small scenes with settings.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/path_scene.h"

namespace gradus::regression {

// Size of the pictures and edge of a block, in pixels.
inline constexpr uint32_t kWidth = 128, kHeight = 72, kBlock = 8;

struct Picture {
  std::string name;
  std::function<void(test::PathScene*)> build;
  std::function<void(GradusSettings*)> change;  // changes the settings that render() starts from
  // Whether the mean depends on the number of samples, so that stored and compared pictures need equally many.
  bool is_biased = false;
};

// Returns all pictures, with unique names.
std::vector<Picture> pictures();

// Renders a picture and returns its Combined pass as RGBA.
std::vector<float> render(const Picture& picture, uint32_t samples, uint32_t seed);
// Returns the mean RGB of each block of 8×8 pixels.
std::vector<float> block_means(const std::vector<float>& rgba);

}  // namespace gradus::regression
