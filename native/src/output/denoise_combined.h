// Denoises the Combined pass with the host's denoiser (output/denoise.h), guided by the features of the film.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "output/oidn_library.h"
#include "reconstruct/reconstructed.h"

namespace gradus::scene {
class Device;
}  // namespace gradus::scene

namespace gradus::output {

// Returns the library that a GradusDenoiser value stands for on this machine. Returns nullptr, with the reason in
// *why_not, if the value is NONE, or if it is AUTO and no library is found. Throws UNSUPPORTED if the value is OIDN and
// no library is found. `device` knows the path to look at and may be nullptr.
std::shared_ptr<const OidnLibrary> choose_denoiser(uint32_t denoiser, const scene::Device* device,
                                                   std::string* why_not);

// A picture to denoise.
struct CombinedPicture {
  const film::Film& film;
  uint32_t reconstruction;         // by which it was computed
  Region region;                   // its pixels
  const std::vector<float>& rgba;  // of `region`
  // What the film and other frames have sampled of the pixels of the whole film; null if no frames are joined.
  const reconstruct::SampledPicture* joined = nullptr;
};

// Returns the denoised picture as RGBA; its alpha is kept. For REGULARIZED the result is a mean of the picture and of
// the denoised noisy image, because a network improves little on a picture that is already smooth. The noisy image is
// that of the joined frames if there are several. For other reconstructions the result is the picture denoised. Returns
// an empty vector, with the reason in *failure, if the denoiser fails or memory runs out. Throws Error CANCELLED. It
// must be called from outside of TBB arenas.
std::vector<float> denoise_combined(const OidnLibrary& library, const CombinedPicture& picture, uint32_t threads,
                                    const CancelCheck& cancel, std::string* failure);

// Returns the factor by which denoise_combined() changes the squared error. It is a measured value for REGULARIZED
// (docs/method.md) and 1 for other reconstructions, for which the factor is unknown.
float denoised_error(const CombinedPicture& picture);

}  // namespace gradus::output
