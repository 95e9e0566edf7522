// Computes the light passes of a reconstructed picture. They are as free of noise as the picture and add up to it.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "reconstruct/regression/halved_image.h"

namespace gradus::output {

// Returns whether the film has at least one light pass.
bool has_light_passes(const film::Film& film);

// Returns the samples of all light passes that the film has, in the order of its channels, then those of the light that
// belongs to none of them, if there may be such light.
std::vector<reconstruct::HalvedImage> read_light_terms(const film::Film& film);

// Returns all light passes that the film has, by their numbers, with 3 floats for each pixel of the region. `rgba` is
// the reconstructed picture of `region`, to which the light passes add up. `sampled` is what read_light_terms()
// returns, or the same of several frames. Passes that have a colour pass are divided by it, as in Cycles. Throws Error
// CANCELLED.
std::map<uint32_t, std::vector<float>> split_light(const film::Film& film, const Region& region,
                                                   const std::vector<float>& rgba,
                                                   std::vector<reconstruct::HalvedImage> sampled,
                                                   const CancelCheck& cancel);

}  // namespace gradus::output
