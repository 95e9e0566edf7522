#include "reconstruct/noise_left.h"

#include "reconstruct/minimise_by_noise.h"
#include "reconstruct/twicing.h"

namespace gradus {
namespace {

std::vector<float> half_difference(const std::array<std::vector<float>, kHalves>& halves) {
  std::vector<float> result(halves[0].size());
  for (size_t i = 0; i < result.size(); ++i) result[i] = 0.5f * (halves[0][i] - halves[1][i]);
  return result;
}

GradientImages half_differences(const GradientImages& images) {
  GradientImages result;
  result.width = images.width;
  result.height = images.height;
  result.channels = images.channels;
  result.primal = half_difference(images.primal_half);
  result.dx = half_difference(images.dx_half);
  result.dy = half_difference(images.dy_half);
  return result;
}

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

NoiseLeft noise_left(const GradientImages& images, uint32_t reconstruction, float alpha, const CancelTest& cancel) {
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) return {images.primal, half_difference(images.primal_half)};
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    SolveReport report;
    return {reconstruct(images, reconstruction, alpha, cancel, &report), noise_left_by_l2(images, alpha, cancel)};
  }
  // L1, too: its weights are of the same kind, and those of the noise are known without iterating.
  return left_by_weighted(images, half_differences(images), chosen_alpha(reconstruction, alpha), cancel);
}

std::vector<float> noise_left_by_l2(const GradientImages& images, float alpha, const CancelTest& cancel) {
  SolveReport report;
  return reconstruct(half_differences(images), GRADUS_RECONSTRUCTION_L2, alpha, cancel, &report);
}

}  // namespace gradus
