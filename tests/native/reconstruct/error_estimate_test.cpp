// The estimate of a reconstruction's squared error by pixels.
#include "reconstruct/error_estimate.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"
#include "film/film.h"
#include "reconstruct/reconstruct_film.h"
#include "schema/pass_table.h"
#include "support/refusal.h"
#include "support/statistics.h"

namespace gradus::error_estimate_test {
namespace {

using test::mean;

const CancelCheck kNever = [] { return false; };

// Returns a film with equal values in both half-buffers; tests then add differences to them.
film::Film make_frame(int width, int height, uint32_t samples_a, uint32_t samples_b, bool gradients) {
  film::Film film(uint32_t(width), uint32_t(height), {0, 0, width, height}, 3, 1, gradients);
  const size_t pixels = size_t(width) * size_t(height);
  const uint32_t samples[film::kHalves] = {samples_a, samples_b};
  for (int half = 0; half < film::kHalves; ++half) {
    film.count[half].assign(pixels, samples[half]);
    film.components[0].primal[half].assign(pixels, Radiance(0.5f, 1.0f, 2.0f, 0.0f) * float(samples[half]));
    for (auto& count : film.pair_count[half]) count.assign(gradients ? pixels : 0, float(samples[half]));
  }
  return film;
}

void add_noise(float sigma, unsigned seed, film::Film* film) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, sigma);
  for (int half = 0; half < film::kHalves; ++half) {
    for (Radiance& sum : film->components[0].primal[half]) {
      const float x = normal(random), y = normal(random), z = normal(random);
      sum += Radiance(x, y, z, 0.0f);
    }
  }
}

std::vector<float> error_of(const film::Film& film, uint32_t reconstruction) {
  reconstruct::SolveReport report;
  return reconstruct::reconstruct_film(film, reconstruction, 0.0f, {.error = true}, kNever, &report).error;
}

constexpr uint32_t kAll[] = {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1};

// Each half-buffer has one sample of variance σ²: the variance of the mean is σ²/2.
TEST(ErrorEstimate, OfTheNoisyImageIsTheVarianceOfItsMean) {
  film::Film film = make_frame(64, 48, 1, 1, false);
  add_noise(0.3f, 5, &film);
  const std::vector<float> error = error_of(film, GRADUS_RECONSTRUCTION_NONE);
  ASSERT_EQ(error.size(), 64u * 48u);
  EXPECT_NEAR(mean(error), 0.5 * 0.09, 0.05 * 0.045);
  for (const float e : error) {
    EXPECT_GT(e, 0.3f * 0.045f) << "a pixel's own difference has one degree of freedom";
    EXPECT_LT(e, 2.5f * 0.045f);
  }
}

// Noise that no reconstruction removes, in half-buffers with different numbers of samples.
TEST(ErrorEstimate, OfDifferentHalvesIsTheSquareOfHalfTheirDistance) {
  film::Film film = make_frame(40, 30, 3, 2, true);
  for (Radiance& sum : film.components[0].primal[0]) sum += Radiance(3.0f * 0.7f);
  for (Radiance& sum : film.components[0].primal[1]) sum += Radiance(2.0f * -0.7f);
  for (const uint32_t reconstruction : kAll) {
    for (const float e : error_of(film, reconstruction)) ASSERT_NEAR(e, 0.49f, 0.005f) << reconstruction;
  }
}

TEST(ErrorEstimate, ExistsOnlyIfRequested) {
  const film::Film film = make_frame(8, 8, 2, 2, true);
  reconstruct::SolveReport report;
  for (const uint32_t reconstruction : kAll) {
    EXPECT_TRUE(reconstruct::reconstruct_film(film, reconstruction, 0.0f, {}, kNever, &report).error.empty());
  }
}

// Regression: windows across the border counted the black outside as pixels without error.
TEST(ErrorEstimate, IsAsLargeAtTheBorder) {
  reconstruct::ErrorTerms terms;
  terms.noise.assign(size_t{3} * 20 * 15, 2.0f);
  for (const float e : reconstruct::error_of_pixels(terms, 20, 15, 3)) EXPECT_FLOAT_EQ(e, 4.0f);
}

TEST(ErrorEstimate, FallsWithTheDistanceFromANoisyPixel) {
  reconstruct::ErrorTerms terms;
  terms.noise.assign(size_t{3} * 41 * 41, 0.0f);
  for (int c = 0; c < 3; ++c) terms.noise[3 * (20 * 41 + 20) + size_t(c)] = 10.0f;
  const std::vector<float> error = reconstruct::error_of_pixels(terms, 41, 41, 3);
  EXPECT_NEAR(std::accumulate(error.begin(), error.end(), 0.0), 100.0, 0.1);
  for (int x = 20; x < 24; ++x) {
    EXPECT_LT(error[20 * 41 + size_t(x) + 1], error[20 * 41 + size_t(x)]);
    EXPECT_FLOAT_EQ(error[20 * 41 + size_t(x)], error[size_t(x) * 41 + 20]) << "in both directions";
  }
  EXPECT_EQ(error[0], 0.0f);
}

// The squared distance from the image of L2 is subtracted from the estimated error of L2, but not more than three
// quarters of it.
TEST(ErrorEstimate, OfABetterImageIsThatOfL2LessTheirDistance) {
  EXPECT_EQ(reconstruct::squared_error(4.0, 1.0), 3.0);
  EXPECT_EQ(reconstruct::squared_error(4.0, 5.0), 1.0);
  reconstruct::ErrorTerms terms;
  terms.noise.assign(size_t{3} * 30 * 30, 2.0f);
  terms.l2_difference.assign(terms.noise.size(), 1.0f);
  for (const float e : reconstruct::error_of_pixels(terms, 30, 30, 3)) EXPECT_FLOAT_EQ(e, 3.0f);
}

// Regression: half of a single sample counted as the difference of two, so that a picture of one sample seemed to have
// half the error.
TEST(ErrorEstimate, WhereAHalfIsEmptyIsTheSquareOfThePicture) {
  for (const bool first : {true, false}) {
    const film::Film film = make_frame(24, 17, first ? 1 : 0, first ? 0 : 1, true);
    for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2}) {
      for (const float e : error_of(film, reconstruction))
        EXPECT_NEAR(e, (0.25f + 1.0f + 4.0f) / 3.0f, 1e-3f) << reconstruction;
    }
  }
}

TEST(ErrorEstimate, IsFiniteForAnySizeSampleCountAndValue) {
  const int sizes[][2] = {{1, 1}, {1, 40}, {40, 1}, {2, 3}, {37, 23}};
  for (const auto& [width, height] : sizes) {
    for (const auto& [a, b] : {std::pair(0u, 0u), std::pair(1u, 0u), std::pair(3u, 2u)}) {
      for (const float scale : {1.0f, 1e30f}) {
        film::Film film = make_frame(width, height, a, b, true);
        if (a + b > 0) add_noise(scale, 3, &film);
        for (const uint32_t reconstruction : kAll) {
          const std::vector<float> error = error_of(film, reconstruction);
          ASSERT_EQ(error.size(), size_t(width * height));
          for (const float e : error)
            ASSERT_TRUE(std::isfinite(e) && e >= 0.0f) << width << "x" << height << ", " << reconstruction;
        }
      }
    }
  }
}

// The film was rendered with settings that do not sample the planes of the reconstruction.
TEST(ErrorEstimate, AndReconstructionRefuseFilmsWithoutNeededPlanes) {
  film::Film film = make_frame(8, 8, 2, 2, false);
  const auto message = [&](uint32_t reconstruction) {
    return test::refusal_of([&] { error_of(film, reconstruction); });
  };
  EXPECT_NE(message(GRADUS_RECONSTRUCTION_L2).find("no gradients"), std::string::npos);
  EXPECT_NE(message(GRADUS_RECONSTRUCTION_REGULARIZED).find("no denoising features"), std::string::npos);
  film::add_pass_channels(schema::feature_passes(), &film);
  EXPECT_EQ(message(GRADUS_RECONSTRUCTION_REGULARIZED).find("no denoising features"), std::string::npos);
}

}  // namespace
}  // namespace gradus::error_estimate_test
