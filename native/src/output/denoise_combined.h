// Combined by the host's denoiser (output/denoise.h), guided by what the frame knows of the surfaces.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "output/oidn_library.h"

namespace gradus::scene {
class Device;
}  // namespace gradus::scene

namespace gradus::output {

// What a GradusDenoiser is here: nullptr where nothing is to be done, and why. Throws UNSUPPORTED where that is refused
// (contract 5.1). device: knows where to look; may be nullptr.
std::shared_ptr<const OidnLibrary> choose_denoiser(uint32_t denoiser, const scene::Device* device,
                                                   std::string* why_not);

// combined: RGBA of `region`, what `reconstruction` has made of the frame; alpha stays. What comes out is that
// denoised, but the mean of it and of the noisy image denoised where it is REGULARIZED: a network makes nothing more of
// what is smooth. Empty where something went wrong, memory included, and what. Throws Error CANCELLED. Call it from
// outside of TBB's arenas.
std::vector<float> denoise_combined(const OidnLibrary& library, const film::Film& film, uint32_t reconstruction,
                                    const Region& region, uint32_t threads, const CancelCheck& cancel,
                                    const std::vector<float>& combined, std::string* failure);

// Squared error of what comes out, over that of what went in: as measured where it is a mean with REGULARIZED
// (docs/method.md), and 1, as nobody knows, elsewhere.
float denoised_error(uint32_t reconstruction);

}  // namespace gradus::output
