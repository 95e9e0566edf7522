// The noise by which blocks stop is the estimate of the pass Error.
#include "render/block_noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "reconstruct/feature_film.h"
#include "reconstruct/reconstruct_film.h"

namespace gradus::block_noise_test {
namespace {

const CancelCheck kNever = [] { return false; };
constexpr float kExposure = 2.0f;

film::Film noisy_room(bool gradients) {
  test::FeatureFilm description = test::room(40, 32);
  description.gradients = gradients;
  film::Film film = test::make_feature_film(description);
  film.settings.film_exposure = kExposure;
  return film;
}

// Returns the root of the mean squared error over the mean squared gray, from the sums of the estimate over the block.
double relative_error(const film::Film& film, const reconstruct::Reconstructed& result, const Region& block,
                      double error) {
  double signal = 0.0;
  for (int32_t y = block.y0; y < block.y1; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) {
      const float* v = &result.image[3 * film.index(x, y)];
      const double gray = kExposure * (double(v[0]) + v[1] + v[2]) / 3.0;
      signal += gray * gray + 1e-3;
    }
  }
  return std::sqrt(kExposure * kExposure * error / signal);
}

double sum_over(const film::Film& film, const std::vector<float>& pixels, const Region& block) {
  double sum = 0.0;
  for (int32_t y = block.y0; y < block.y1; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) sum += pixels[film.index(x, y)];
  }
  return sum;
}

// A reconstruction by features removes the noise of the half-buffers, which says nothing about its error: its own
// estimate is used. The pass Error counts lost light by another factor, and this film has hardly any.
TEST(BlockNoise, OfAReconstructionThatEstimatesItsErrorIsThatEstimate) {
  for (const bool gradients : {false, true}) {
    const film::Film film = noisy_room(gradients);
    reconstruct::SolveReport report;
    const reconstruct::Reconstructed result =
        reconstruct::reconstruct_film(film, GRADUS_RECONSTRUCTION_REGULARIZED, 0.0f, {.error = true}, kNever, &report);
    const std::vector<Region> blocks = {{0, 0, 16, 16}, {16, 0, 40, 32}};
    const std::vector<render::BlockNoise> noise =
        render::estimate_noise(film, blocks, GRADUS_RECONSTRUCTION_REGULARIZED, 0.0f, kNever);
    ASSERT_EQ(noise.size(), blocks.size());
    for (size_t k = 0; k < blocks.size(); ++k) {
      const double error = sum_over(film, result.error, blocks[k]);
      ASSERT_GT(error, 0.0);
      EXPECT_NEAR(noise[k].relative_error / relative_error(film, result, blocks[k], error), 1.0, 1e-3);
      EXPECT_GT(noise[k].spread, 0.0);
    }
  }
}

// With the whole picture as one block, the error that the windows of the pass spread stays in it, apart from losses at
// the border.
TEST(BlockNoise, OfThePictureIsTheSumOfThePass) {
  const film::Film film = noisy_room(true);
  for (const uint32_t how : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2}) {
    reconstruct::SolveReport report;
    const reconstruct::Reconstructed result =
        reconstruct::reconstruct_film(film, how, 0.0f, {.error = true}, kNever, &report);
    const render::BlockNoise noise = render::estimate_noise(film, {film.region}, how, 0.0f, kNever).front();
    const double error = sum_over(film, result.error, film.region);
    EXPECT_NEAR(noise.relative_error / relative_error(film, result, film.region, error), 1.0, 0.02) << how;
  }
}

}  // namespace
}  // namespace gradus::block_noise_test
