// Computes the light passes and the light groups of a reconstructed picture. They are as free of noise as the picture.
// All light passes add up to it, and so do all light groups with the light that is in none. What a transparent film
// hides is in the Environment pass, beside that sum, and in light groups.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"

namespace gradus::output {

// Returns whether the film has at least one light pass or light group.
bool has_light_passes(const film::Film& film);

// Returns the samples of all light passes that the film has, in the order of its channels, then those of the light that
// belongs to none of them, if there may be such light; the same of light groups; the light that a transparent film
// hides, if the film holds it; and the colour passes by which light passes are divided.
reconstruct::SampledTerms read_light_terms(const film::Film& film);

// Passes by their numbers, with 3 floats for each pixel of a region.
using LightPasses = std::map<uint32_t, std::vector<float>>;

struct SplitLight {
  LightPasses passes;
  std::map<std::string, std::vector<float>> groups;  // by the names of their channels
};

// Returns all light passes and light groups that the film has. `rgba` is the reconstructed picture of `region`, to
// which they add up. `sampled` is what read_light_terms() returns, or the same of several frames. Passes that have a
// colour pass are divided by it, as in Cycles. Throws Error CANCELLED.
SplitLight split_light(const film::Film& film, const Region& region, const std::vector<float>& rgba,
                       reconstruct::SampledTerms sampled, const CancelCheck& cancel);
// Returns the colour passes of `sampled`.
LightPasses color_passes(const film::Film& film, const Region& region, const reconstruct::SampledTerms& sampled);

}  // namespace gradus::output
