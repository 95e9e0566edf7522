#include "reconstruct/weighted_noise.h"

#include "reconstruct/minimise_by_noise.h"
#include "reconstruct/twicing.h"

namespace gradus::reconstruct {
namespace {

// An error estimate needs no higher accuracy.
constexpr CgGoal kGoal{.residual = 1e-2f, .row_error = 0.1f};
constexpr int kMaxSteps = 10;

}  // namespace

RemainingNoise remaining_noise(const film::GradientImages& images, const film::GradientImages& half_differences,
                               float alpha, const CancelCheck& cancel) {
  alpha = chosen_alpha(GRADUS_RECONSTRUCTION_L1, alpha);
  SolveReport report;
  Minimum minimum = minimise_by_noise(images, cancel, &report);
  const int channels = minimum.solution.channels();
  Field noise(images.width, images.height, channels);
  minimum.system.solve(load_planes(planes_of(half_differences, 0), images.width, images.height, channels), kGoal,
                       kMaxSteps, cancel, &noise);
  const Twicing twicing(images, minimum.solution, alpha);
  const size_t stride = size_t(images.channels);
  RemainingNoise result{std::vector<float>(images.primal.size()), std::vector<float>(images.primal.size())};
  for (int c = 0; c < channels; ++c) {
    store_channel(minimum.solution, c, stride, result.image.data() + c);
    twicing.apply(planes_of(images, c), result.image.data() + c);
    store_channel(noise, c, stride, result.noise.data() + c);
    twicing.apply(planes_of(half_differences, c), result.noise.data() + c);
  }
  return result;
}

}  // namespace gradus::reconstruct
