#include "render/develop.h"

#include "base/clock.h"

namespace gradus::render {

void develop(output::Developer* developer, const reconstruct::ReconstructionOutputs& wanted,
             const output::Developer::Source& source, const std::function<void()>& show,
             output::DevelopedFilm* developed, RenderStats* stats) {
  {
    const ScopedTimer timer(&stats->seconds.reconstruct, &stats->cpu_seconds.reconstruct);
    developer->reconstruct(developed, wanted, source);
  }
  stats->solve = developed->solve;
  show();
  if (developed->options.denoiser != GRADUS_DENOISER_NONE) {
    const ScopedTimer timer(&stats->seconds.denoise, &stats->cpu_seconds.denoise);
    std::vector<std::string> warnings;
    if (developer->denoise(developed, &warnings)) {
      stats->denoiser = developer->denoiser_name();
    } else if (!warnings.empty()) {
      stats->leave_out(warnings.back(), developed->film->settings.strict != 0);
      warnings.pop_back();
    }
    stats->warnings.insert(stats->warnings.end(), warnings.begin(), warnings.end());
    show();
  }
  const ScopedTimer timer(&stats->seconds.reconstruct, &stats->cpu_seconds.reconstruct);
  developer->split(developed);
  show();
}

}  // namespace gradus::render
