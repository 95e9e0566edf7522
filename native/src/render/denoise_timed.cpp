#include "render/denoise_timed.h"

#include "base/clock.h"

namespace gradus::render {

std::vector<float> denoise_timed(const output::OidnLibrary& library, const film::Film& film, const Region& region,
                                 uint32_t threads, const CancelCheck& cancel, const std::vector<float>& combined,
                                 RenderStats* stats) {
  const ScopedTimer timer(&stats->seconds.denoise, &stats->cpu_seconds.denoise);
  std::string failure;
  std::vector<float> rgba = output::denoise_combined(library, film, film.settings.reconstruction, region, threads,
                                                     cancel, combined, &failure);
  if (rgba.empty()) {
    stats->leave_out(failure, film.settings.strict != 0);
  } else {
    stats->denoiser = library.name();
  }
  return rgba;
}

}  // namespace gradus::render
