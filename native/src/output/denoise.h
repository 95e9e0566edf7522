// A picture without its noise, by the host's Open Image Denoise: a stage of its own, picture in, picture out.
//
// Its network is guided by albedo and normal of what the camera sees, which it takes to be free of noise. (It could
// clean them first, one by one, as Cycles' "accurate" has it; that is two thirds of the time, and
// reconstruct/feature_filter.h does it for a hundredth of that.)
#pragma once

#include <cstdint>
#include <vector>

#include "base/cancel_check.h"
#include "output/oidn_library.h"

namespace gradus::output {

struct NoisyPicture {
  int width = 0, height = 0;
  const float* color = nullptr;  // scene-linear RGB
  size_t stride = 3;             // floats from pixel to pixel
  // 3 floats per pixel; nullptr: there is none.
  const float* albedo = nullptr;  // 0 to 1
  const float* normal = nullptr;  // -1 to 1; the network takes it only together with the albedo
};

// RGB, 3 floats per pixel, finite. Numbers that are not count as 0. Throws Error CANCELLED, or UNKNOWN with the
// library's text. Call it from outside of TBB's arenas: it brings its own, of `threads`.
std::vector<float> denoise(const OidnLibrary& library, const NoisyPicture& picture, uint32_t threads,
                           const CancelCheck& cancel);

}  // namespace gradus::output
