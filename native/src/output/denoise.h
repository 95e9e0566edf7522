// Denoises a picture with the host's copy of Open Image Denoise. Input and output are plain pictures.
//
// The network is guided by the albedo and the normal of the visible surfaces, which it assumes to be free of noise.
// (The library can denoise these guides first, as Cycles does with its "accurate" prefilter. That takes two thirds of
// the time; reconstruct/regression/feature_filter.h needs a hundredth of that.)
#pragma once

#include <cstdint>
#include <vector>

#include "base/cancel_check.h"
#include "output/oidn_library.h"

namespace gradus::output {

struct NoisyPicture {
  int width = 0, height = 0;
  const float* color = nullptr;  // Scene-linear RGB.
  size_t stride = 3;             // Number of floats from one pixel of `color` to the next.
  // Guides with 3 floats per pixel, or nullptr if there is no such guide.
  const float* albedo = nullptr;  // Values from 0 to 1.
  const float* normal = nullptr;  // Values from -1 to 1. The network accepts it only together with the albedo.
};

// Returns the denoised picture as RGB, 3 finite floats per pixel. Input values that are not finite count as 0. Throws
// Error CANCELLED, or Error UNKNOWN with the library's text. It must be called from outside of TBB arenas, because the
// library makes its own arena of `threads` threads.
std::vector<float> denoise(const OidnLibrary& library, const NoisyPicture& picture, uint32_t threads,
                           const CancelCheck& cancel);

}  // namespace gradus::output
