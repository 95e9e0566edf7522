#include "output/options.h"

#include "base/error.h"
#include "film/features.h"
#include "scene/device.h"

namespace gradus::output {
namespace {

uint32_t resolve_reconstruction(uint32_t reconstruction, const FilmFacts& facts) {
  switch (reconstruction) {
    case GRADUS_RECONSTRUCTION_AUTO:
      if (facts.sampled_for != GRADUS_RECONSTRUCTION_AUTO) return facts.sampled_for;
      if (facts.has_features) return GRADUS_RECONSTRUCTION_REGULARIZED;
      return facts.has_gradients ? GRADUS_RECONSTRUCTION_L1 : GRADUS_RECONSTRUCTION_NONE;
    case GRADUS_RECONSTRUCTION_NONE:
    case GRADUS_RECONSTRUCTION_L2:
    case GRADUS_RECONSTRUCTION_L1:
    case GRADUS_RECONSTRUCTION_REGULARIZED:
      return reconstruction;
    default:
      throw invalid_argument("there is no reconstruction " + std::to_string(reconstruction));
  }
}

uint32_t resolve_denoiser(const Options& options, const FilmFacts& facts) {
  if (options.denoiser != GRADUS_DENOISER_AUTO) return options.denoiser;
  const bool denoises =
      is_denoised_by_default(options.reconstruction) && facts.has_denoiser && denoiser_pays(facts.samples);
  return denoises ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_NONE;
}

}  // namespace

Options options_of(const GradusSettings& settings) {
  return {settings.reconstruction, settings.reconstruction_alpha, settings.denoiser};
}

void store_options(const Options& options, GradusSettings* settings) {
  settings->reconstruction = options.reconstruction;
  settings->reconstruction_alpha = options.alpha;
  settings->denoiser = options.denoiser;
}

FilmFacts facts_of(const film::Film& film, bool has_denoiser) {
  return {GRADUS_RECONSTRUCTION_AUTO, film::has_features(film), film.gradients, film::mean_samples(film), has_denoiser};
}

Options resolve_auto(Options options, const FilmFacts& facts) {
  options.reconstruction = resolve_reconstruction(options.reconstruction, facts);
  options.denoiser = resolve_denoiser(options, facts);
  return options;
}

uint32_t threads_of(const GradusSettings& settings, const scene::Device* device) {
  return settings.threads > 0 ? settings.threads : device != nullptr ? device->threads() : 1;
}

}  // namespace gradus::output
