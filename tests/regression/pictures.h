// The pictures that are stored: small scenes and settings.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/path_scene.h"

namespace gradus::regression {

inline constexpr uint32_t kWidth = 128, kHeight = 72, kBlock = 8;

struct Picture {
  std::string name;
  std::function<void(test::PathScene*)> build;
  std::function<void(GradusSettings*)> change;  // from small defaults
  // Its mean depends on the number of samples: what is stored of it has as many as what is compared with it.
  bool is_biased = false;
};

std::vector<Picture> pictures();

// Combined, RGBA.
std::vector<float> render(const Picture& picture, uint32_t samples, uint32_t seed);
// Means of RGB over squares of 8×8 pixels.
std::vector<float> block_means(const std::vector<float>& rgba);

}  // namespace gradus::regression
