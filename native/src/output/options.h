// The options with which a film is developed, and what AUTO stands for in them.
#pragma once

#include <cstdint>

#include "film/film.h"
#include "gradus/gradus.h"
#include "schema/automatic.h"

namespace gradus::scene {
class Device;
}  // namespace gradus::scene

namespace gradus::output {

struct Options {
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_NONE;
  float alpha = 0.0f;  // weight of the noisy image against the gradients; 0: reconstruct::chosen_alpha()
  uint32_t denoiser = GRADUS_DENOISER_NONE;
  bool operator==(const Options&) const = default;
};

// Returns the options that the settings hold. They may be AUTO.
Options options_of(const GradusSettings& settings);
// Writes the options into the settings of a film, so that its later readers do not choose again.
void store_options(const Options& options, GradusSettings* settings);

// What is known of a film before or after it is sampled. AUTO is resolved by it.
struct FilmFacts {
  uint32_t sampled_for = GRADUS_RECONSTRUCTION_AUTO;  // reconstruction for which it was sampled; AUTO: not known
  bool has_features = false, has_gradients = false;
  double samples = 0.0;       // per pixel; of a frame of a sequence, those of joined frames included
  bool has_denoiser = false;  // whether the machine has a denoiser
};
// Returns the facts that the content of a film shows.
FilmFacts facts_of(const film::Film& film, bool has_denoiser);

// Returns whether AUTO may denoise pictures by this reconstruction, which is not AUTO. A user who chose L2 or the noisy
// image expects an unbiased one, and who chose L1 expects what the solver makes.
inline bool is_denoised_by_default(uint32_t reconstruction) {
  return reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
}

// Returns whether the denoiser reduces the error of a film with `samples` samples per pixel more than further samples
// in the same time would.
inline bool denoiser_pays(double samples) { return samples >= schema::kDenoiserMinimumSamples; }

// Replaces AUTO of the reconstruction and of the denoiser; nothing else does. The integrator is chosen by the plan
// (render/plan.h), and a weight alpha of 0 stands for reconstruct::chosen_alpha(). The reconstruction becomes the one
// for which the film was sampled. If that is not known, it becomes the best one for which the film holds the data. The
// denoiser runs if there is one, the reconstruction is REGULARIZED, and the film has enough samples. Throws
// invalid_argument for a value that is no reconstruction.
Options resolve_auto(Options options, const FilmFacts& facts);

// Returns the number of threads that sample and develop a film with these settings. `device` may be nullptr if
// settings.threads is set.
uint32_t threads_of(const GradusSettings& settings, const scene::Device* device);

}  // namespace gradus::output
