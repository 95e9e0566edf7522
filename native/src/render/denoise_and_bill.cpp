#include "render/denoise_and_bill.h"

#include "base/bill.h"

namespace gradus {

std::vector<float> denoise_and_bill(const OidnLibrary& library, const Frame& frame, const Region& region, uint32_t threads,
                                    const CancelTest& cancel, const std::vector<float>& combined, RenderStats* stats) {
  const Bill bill(&stats->seconds.denoise, &stats->cpu_seconds.denoise);
  std::string failure;
  std::vector<float> rgba = denoise_combined(library, frame, frame.settings.reconstruction, region, threads, cancel, combined, &failure);
  if (rgba.empty()) {
    stats->warnings.push_back(failure);
  } else {
    stats->denoiser = library.name();
  }
  return rgba;
}

}  // namespace gradus
