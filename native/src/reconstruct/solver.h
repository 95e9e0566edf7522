// Reconstruction: from a noisy primal image and its sampled gradients to one image.
//
// A solver is W = estimate(images) and x = W(planes), with W a frozen linear operator (contract 3.4), so that alpha,
// light passes and components can go through the same weights and add up exactly.
#pragma once

#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"

namespace gradus::reconstruct {

// One channel to reconstruct.
struct PoissonPlanes {
  const float* primal = nullptr;
  const float* dx = nullptr;
  const float* dy = nullptr;
  size_t stride = 1;  // floats from pixel to pixel (interleaved channels)
};

inline PoissonPlanes planes_of(const film::GradientImages& images, int channel) {
  return {images.primal.data() + channel, images.dx.data() + channel, images.dy.data() + channel,
          size_t(images.channels)};
}

// A frozen linear operator on (primal, dx, dy).
class LinearOperator {
 public:
  virtual ~LinearOperator() = default;
  // out: width·height values at `stride`. Deterministic for any number of threads.
  virtual void apply(const PoissonPlanes& planes, float* out) const = 0;
};

struct SolveReport {
  int outer_steps = 0;
  int inner_steps = 0;
  float residual = 0.0f;  // relative to the right side
  bool hit_cap = false;
};

// L2, exact by DCT: minimises α²‖x−I‖² + ‖Dx−g‖². Unbiased. (Thesis eq. 5.13 with k = 2; Bhat et al. 2008 for the DCT.)
std::unique_ptr<LinearOperator> make_l2(int width, int height, float alpha);
// L1, with weights that are estimated from the images (all channels together) and then frozen. Consistent, not
// unbiased.
std::unique_ptr<LinearOperator> make_twiced(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                                            const CancelCheck& cancel, SolveReport* report);

// Weight of the primal against the gradients; 0: what measures best. Noisy differences, of paths that met other
// surfaces than their neighbours did, ask L2 for a larger one than the thesis's 0.2; L1's weights do that by
// themselves.
inline float chosen_alpha(uint32_t reconstruction, float alpha) {
  return alpha > 0.0f ? alpha : reconstruction == GRADUS_RECONSTRUCTION_L2 ? 0.4f : 0.2f;
}

// Reconstructs all channels; returns width·height·channels. `reconstruction` is GRADUS_RECONSTRUCTION_L2 or
// GRADUS_RECONSTRUCTION_L1.
std::vector<float> reconstruct(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                               const CancelCheck& cancel, SolveReport* report);

// The same of the images that read_images() makes of a frame's component.
std::vector<float> reconstruct(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                               const CancelCheck& cancel, SolveReport* report);

}  // namespace gradus::reconstruct
