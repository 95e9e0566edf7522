// A picture without its noise, by the host's Open Image Denoise: a stage of its own, picture in, picture out.
//
// Its network is guided by albedo and normal of what the camera sees. They must be free of noise; those that are not go through the network
// by themselves first ("prefiltering" in its documentation; "accurate" in Cycles), which costs as much again for each.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "denoise/oidn_library.h"

namespace gradus {

// An image to be guided by: 3 floats per pixel.
struct Guide {
  const float* pixels = nullptr;  // nullptr: there is none
  bool is_clean = false;          // free of noise: taken as it is
};

struct NoisyPicture {
  int width = 0, height = 0;
  const float* color = nullptr;  // scene-linear RGB
  size_t stride = 3;             // floats from pixel to pixel
  Guide albedo;                  // 0 to 1
  Guide normal;                  // -1 to 1; the network takes it only together with the albedo
};

// RGB, 3 floats per pixel, finite. Numbers that are not count as 0. Throws Error CANCELLED, or UNKNOWN with the library's text. Call it
// from outside of TBB's arenas: it brings its own, of `threads`.
std::vector<float> denoise(const OidnLibrary& library, const NoisyPicture& picture, uint32_t threads, const std::function<bool()>& cancel);

}  // namespace gradus
