// Denoises the Combined pass with the host's denoiser (output/denoise.h), guided by the features of the film.
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

// Returns the library that a GradusDenoiser value stands for on this machine. Returns nullptr, with the reason in
// *why_not, if the value is NONE, or if it is AUTO and no library is found. Throws UNSUPPORTED if the value is OIDN and
// no library is found. `device` knows the path to look at and may be nullptr.
std::shared_ptr<const OidnLibrary> choose_denoiser(uint32_t denoiser, const scene::Device* device,
                                                   std::string* why_not);

// Returns the denoised RGBA picture of `region`. `combined` is the RGBA picture that `reconstruction` has computed from
// the film; its alpha is kept. For REGULARIZED the result is a mean of `combined` and of the denoised noisy image,
// because a network improves little on a picture that is already smooth. Otherwise it is `combined` denoised. Returns
// an empty vector, with the reason in *failure, if the denoiser fails or memory runs out. Throws Error CANCELLED. It
// must be called from outside of TBB arenas.
std::vector<float> denoise_combined(const OidnLibrary& library, const film::Film& film, uint32_t reconstruction,
                                    const Region& region, uint32_t threads, const CancelCheck& cancel,
                                    const std::vector<float>& combined, std::string* failure);

// Returns the factor by which denoise_combined() changes the squared error. It is a measured value for REGULARIZED
// (docs/method.md) and 1 for other reconstructions, for which the factor is unknown.
float denoised_error(uint32_t reconstruction);

}  // namespace gradus::output
