#include "render/combine.h"

#include <algorithm>

#include "base/error.h"
#include "render/pass_read.h"

namespace gradus {
namespace {

std::vector<float> solve_components(const Frame& frame, uint32_t reconstruction, float alpha, const CancelTest& cancel,
                                    SolveReport* report) {
  std::vector<float> sum;
  for (int component = 0; component < int(frame.components.size()); ++component) {
    std::vector<float> image = reconstruct(frame, component, reconstruction, alpha, cancel, report);
    if (sum.empty()) {
      sum = std::move(image);
    } else {
      for (size_t i = 0; i < image.size(); ++i) sum[i] += image[i];
    }
  }
  return sum;
}

}  // namespace

std::vector<float> combine(const Frame& frame, uint32_t reconstruction, float alpha, const Region& region, const CancelTest& cancel,
                           SolveReport* report) {
  std::vector<float> rgba(size_t(region.area()) * 4);
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) {
    read_frame_pass(frame, GRADUS_PASS_NOISY_IMAGE, region, rgba.data());
    return rgba;
  }
  if (!frame.gradients) throw invalid_operation("the frame holds no gradients to reconstruct from");
  const std::vector<float> image = solve_components(frame, reconstruction, alpha, cancel, report);
  const float exposure = frame.settings.film_exposure;
  const bool keeps_negative = reconstruction == GRADUS_RECONSTRUCTION_L2;
  float* p = rgba.data();
  for (int32_t y = region.y0; y < region.y1; ++y) {
    for (int32_t x = region.x0; x < region.x1; ++x, p += 4) {
      const float* from = image.data() + frame.index(x, y) * size_t(frame.channels);
      for (int c = 0; c < 3; ++c) p[c] = exposure * (keeps_negative ? from[c] : std::max(from[c], 0.0f));
      p[3] = frame.channels == 4 ? std::clamp(from[3], 0.0f, 1.0f) : 1.0f;
    }
  }
  return rgba;
}

}  // namespace gradus
