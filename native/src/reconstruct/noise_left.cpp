#include "reconstruct/noise_left.h"

#include "reconstruct/minimise_by_noise.h"
#include "reconstruct/twicing.h"

namespace gradus {
namespace {

// The estimate needs no more digits than this.
constexpr CgGoal kGoal{.residual = 1e-2f, .row_error = 0.1f};
constexpr int kMostSteps = 10;

// By the weights that the image gets. Channels beyond the third, which have no part in these, stay 0.
NoiseLeft left_by_weighted(const GradientImages& images, const GradientImages& differences, float alpha, const CancelTest& cancel) {
  SolveReport report;
  Minimum minimum = minimise_by_noise(images, cancel, &report);
  const int channels = minimum.solution.channels();
  Field noise(images.width, images.height, channels);
  minimum.system.solve(load_planes(planes_of(differences, 0), images.width, images.height, channels), kGoal, kMostSteps, cancel, &noise);
  const Twicing twicing(images, minimum.solution, alpha);
  const size_t stride = size_t(images.channels);
  NoiseLeft left{std::vector<float>(images.primal.size()), std::vector<float>(images.primal.size())};
  for (int c = 0; c < channels; ++c) {
    store_channel(minimum.solution, c, stride, left.image.data() + c);
    twicing.apply(planes_of(images, c), left.image.data() + c);
    store_channel(noise, c, stride, left.noise.data() + c);
    twicing.apply(planes_of(differences, c), left.noise.data() + c);
  }
  return left;
}

}  // namespace

NoiseLeft noise_left(const GradientImages& images, const GradientImages& half_differences, uint32_t reconstruction, float alpha,
                     const CancelTest& cancel) {
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) return {images.primal, half_differences.primal};
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    SolveReport report;
    return {reconstruct(images, reconstruction, alpha, cancel, &report),
            reconstruct(half_differences, reconstruction, alpha, cancel, &report)};
  }
  // L1, too: its weights are of the same kind, and those of the noise are known without iterating.
  return left_by_weighted(images, half_differences, chosen_alpha(reconstruction, alpha), cancel);
}

}  // namespace gradus
