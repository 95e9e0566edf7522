// B1, B2 and bad input for REGULARIZED.
#include "reconstruct/regularized.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "reconstruct/feature_film.h"
#include "reconstruct/regression/regression_error.h"
#include "support/threads.h"

namespace gradus::regularized_test {
namespace {

using namespace test;

constexpr int kWidth = 72, kHeight = 50;

reconstruct::Reconstructed solve_with_error(const film::Film& film) {
  reconstruct::SolveReport report;
  return reconstruct::regularize(film, false, never, &report);
}

std::vector<float> solve(const film::Film& film) { return solve_with_error(film).image; }
std::vector<float> noisy(const film::Film& film) { return film::read_images(film, 0).primal; }

// Adds noise of +`offset` and −`offset` to the two half-buffers everywhere: no window removes any of it, so that its
// share in all estimates is known.
film::Film with_common_noise(FeatureFilm description, float offset) {
  description.sigma = [](size_t) { return 0.0f; };
  film::Film film = make_feature_film(description);
  for (int half = 0; half < film::kHalves; ++half) {
    for (Radiance& pixel : film.components[0].primal[half]) pixel += Radiance(half == 0 ? offset : -offset);
  }
  return film;
}

// Returns a pseudo-random value in [0, 1).
float hashed(int x, int y, int channel, int half) {
  const double s = std::sin(12.9898 * x + 78.233 * y + 37.719 * channel + 91.17 * half) * 43758.5453;
  return float(s - std::floor(s));
}

// Returns a checkerboard that no feature describes: for windows, it is bias.
FeatureFilm chequered(float level, float amplitude) {
  FeatureFilm film{kWidth, kHeight, {}, {}, [](int, int, int, int) { return 0.5f; }};
  film.truth = make_image(kWidth, kHeight, 3, [&](int x, int y, int) { return level + amplitude * chequer(x, y); });
  return film;
}

// Returns the remaining amplitude of the checkerboard far from the border.
double amplitude_of(const std::vector<float>& image) {
  double sum = 0.0;
  int count = 0;
  for (int y = 12; y < kHeight - 12; ++y) {
    for (int x = 12; x < kWidth - 12; ++x, ++count) sum += chequer(x, y) * image[3 * (size_t(y) * kWidth + size_t(x))];
  }
  return sum / count;
}

void expect_finite_and_bounded(const film::Film& film, float bound) {
  const reconstruct::Reconstructed result = solve_with_error(film);
  for (const float v : result.image) ASSERT_LE(std::fabs(v), bound);
  for (const float v : result.error) ASSERT_TRUE(v >= 0.0f && v <= std::numeric_limits<float>::max()) << v;
}

TEST(B2_Regularized, RemovesMostOfTheNoise) {
  FeatureFilm description = room(kWidth, kHeight);
  for (const bool gradients : {false, true}) {
    description.gradients = gradients;
    const film::Film film = make_feature_film(description);
    EXPECT_LT(rms_difference(solve(film), description.truth),
              (gradients ? 0.2 : 0.3) * rms_difference(noisy(film), description.truth));
  }
}

// Shadows, caustics and reflections are in no feature: the differences have to describe them.
TEST(B2_Regularized, DifferencesDescribeWhatFeaturesDoNot) {
  FeatureFilm description = room(96, 64);
  const std::vector<float> shadow = make_image(
      96, 64, 3, [](int x, int y, int) { return (x - 50) * (x - 50) + (y - 30) * (y - 30) < 150 ? 0.3f : 1.0f; });
  for (size_t i = 0; i < shadow.size(); ++i) description.truth[i] *= shadow[i];
  const double without = rms_difference(solve(make_feature_film(description)), description.truth);
  description.gradients = true;
  EXPECT_LT(rms_difference(solve(make_feature_film(description)), description.truth), 0.6 * without);
}

// REGULARIZED is consistent: a hundred times the samples leave less than a fifth of the error, whatever the features
// are.
TEST(B2_Regularized, ErrorFallsWithTheNoise) {
  FeatureFilm description = room(kWidth, kHeight);
  description.feature = [](int x, int, int, int) { return float(x % 3) / 3.0f; };  // unrelated to the picture
  double before = std::numeric_limits<double>::infinity();
  for (const float sigma : {0.4f, 0.04f, 0.004f}) {
    description.sigma = [sigma](size_t) { return sigma; };
    const double error = rms_difference(solve(make_feature_film(description)), description.truth);
    EXPECT_LT(error, 0.2 * before) << sigma;
    before = error;
  }
}

// Texture that is in no feature, hair, fine shadows: without noise, nothing is changed; with little noise, little.
TEST(B2_Regularized, KeepsDetailWithoutNoise) {
  FeatureFilm description = room(kWidth, kHeight);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 2.0f);
  for (float& v : description.truth) v = uniform(random);
  for (const float sigma : {0.0f, 1e-3f, 1e-2f}) {
    description.sigma = [sigma](size_t) { return sigma; };
    const film::Film film = make_feature_film(description);
    EXPECT_LE(rms_difference(solve(film), description.truth),
              1.2 * rms_difference(noisy(film), description.truth) + 1e-4)
        << sigma;
  }
}

TEST(B2_Regularized, ScalesWithTheImage) {
  for (const bool gradients : {false, true}) {
    FeatureFilm description = room(kWidth, kHeight);
    description.gradients = gradients;
    reconstruct::Reconstructed small = solve_with_error(make_feature_film(description));
    for (float& v : description.truth) v *= 1024.0f;
    description.sigma = [](size_t) { return 1024.0f * 0.4f; };
    const reconstruct::Reconstructed large = solve_with_error(make_feature_film(description));
    for (float& v : small.image) v *= 1024.0f;
    EXPECT_LT(max_difference(small.image, large.image), 1e-2 * 1024.0);
    EXPECT_NEAR(mean(large.error) / mean(small.error), 1024.0 * 1024.0, 0.01 * 1024.0 * 1024.0);
  }
}

// Alpha, which is an eighth of red in these films, uses the weights of the colours, including those of outliers. Light
// that is lost is restored in the colours alone.
// Regression: with differences, alpha was that of the regression alone, so that coverage and colour of an edge were
// smoothed differently.
TEST(B2_Regularized, AlphaUsesTheWeightsOfTheColours) {
  FeatureFilm description = room(kWidth, kHeight);
  description.difference_sigma = 0.1f;
  for (const bool gradients : {false, true}) {
    description.gradients = gradients;
    for (const float firefly : {0.0f, 800.0f}) {
      film::Film film = make_feature_film(description, 4);
      film.components[0].primal[0][size_t(20 * kWidth + 30)] += Radiance(firefly, firefly, firefly, firefly / 8.0f);
      const std::vector<float> rgba = solve(film);
      for (size_t i = 0; i < rgba.size(); i += 4)
        ASSERT_NEAR(8.0f * rgba[i + 3], rgba[i], 1e-2f) << i / 4 << ", " << gradients;
    }
  }
}

TEST(B2_Regularized, HasTheSameBitsForAnyNumberOfThreads) {
  FeatureFilm description = room(170, 140);
  description.gradients = true;
  const film::Film film = make_feature_film(description);
  expect_same_bits_for_any_number_of_threads([&] { return solve(film); });
}

// The weights hide a part of the noise if rare samples are far brighter than the others. The noise of these films has
// no such samples: the estimate is kHidden times too large.
TEST(B2_Regularized, EstimatesItsError) {
  FeatureFilm description = room(160, 120);
  double estimated = 0.0, actual = 0.0;
  for (description.seed = 1; description.seed <= 4; ++description.seed) {
    const reconstruct::Reconstructed result = solve_with_error(make_feature_film(description));
    for (const float v : result.error) estimated += v / double(result.error.size());
    actual += std::pow(rms_difference(result.image, description.truth), 2.0);
  }
  EXPECT_GT(estimated / actual, 1.0);
  EXPECT_LT(estimated / actual, 1.2 * reconstruct::kHidden);
}

// The estimate contains the noise that windows cannot remove, and the part of the picture that no feature explains.
TEST(B2_Regularized, ErrorIsVarianceAndSquaredBias) {
  for (const float amplitude : {0.0f, 0.5f}) {
    for (const float offset : {1.0f, 2.0f}) {
      const reconstruct::Reconstructed result = solve_with_error(with_common_noise(chequered(1.0f, amplitude), offset));
      const double expected = reconstruct::kHidden * offset * offset + amplitude * amplitude;
      EXPECT_NEAR(mean(result.error), expected, 0.03 * expected) << amplitude << ", " << offset;
    }
  }
}

// Normals, albedos and depths of these films are random: those of other pixels explain nothing.
TEST(B2_Regularized, KeepsImagesThatTheFeaturesExplain) {
  FeatureFilm description{kWidth, kHeight, {}, {}, [](int x, int y, int channel, int) {
                            const float wave =
                                std::sin(0.9f * float(x * (channel + 1)) + 0.37f * float(y * y * (channel + 2)));
                            return channel < 6 ? wave : wave > 0.0f ? 3.0f : 1.0f;
                          }};
  for (int explained = 0; explained < 7; ++explained) {
    description.truth = make_image(kWidth, kHeight, 3,
                                   [&](int x, int y, int) { return 5.0f + description.feature(x, y, explained, 0); });
    EXPECT_LT(rms_difference(solve(with_common_noise(description, 1.0f)), description.truth), 0.02) << explained;
  }
}

// Half the difference of the half-buffers is the uncertainty of a pixel's own value. Where windows are wrong by five
// times its square, it has a third of all weight.
TEST(B2_Regularized, WeightsPixelsByTheirVariance) {
  const double share = amplitude_of(solve(with_common_noise(chequered(100.0f, 2.0f), 1.0f))) / 2.0;
  EXPECT_GT(share, 0.2);
  EXPECT_LT(share, 0.5);
}

// Regression: gaps between small balls, darker than their surroundings and with less noise, were assumed to be as noisy
// as the balls and got their light: with 128 samples, more than twice the error of the samples alone.
TEST(B2_Regularized, DarkGapsBetweenBrightNoisyPixelsStayDark) {
  const auto is_gap = [](int x, int y) { return x % 3 == 0 && y % 3 == 0; };
  FeatureFilm description{kWidth, kHeight, {}, {}, [](int, int, int, int) { return 0.5f; }};
  description.truth = make_image(kWidth, kHeight, 3, [&](int x, int y, int) { return is_gap(x, y) ? 0.05f : 1.0f; });
  description.sigma = [&](size_t i) { return is_gap(int(i % kWidth), int(i / kWidth)) ? 0.02f : 0.25f; };
  const std::vector<float> image = solve(make_feature_film(description));
  double gaps = 0.0;
  int count = 0;
  for (int y = 0; y < kHeight; y += 3) {
    for (int x = 0; x < kWidth; x += 3, ++count) gaps += image[3 * (size_t(y) * kWidth + size_t(x))];
  }
  std::printf("  gaps have %.3f of 0.05\n", gaps / count);
  EXPECT_LT(gaps / count, 0.3);
}

// One sample in sixteen carries all the light: windows take it for an outlier, and the first step loses nearly all of
// it. The second step restores half of it, by the albedo, and factors the rest, also where windows reach over an edge.
// Only one half-buffer has such samples, so that all of it may be chance; the error reflects that.
TEST(B2_Regularized, RestoresTheLightOfRareSamples) {
  const auto albedo = [](int x) { return (x / 6) % 2 ? 0.8f : 0.2f; };
  FeatureFilm description{kWidth,
                          kHeight,
                          {},
                          [](size_t) { return 0.0f; },
                          [&](int x, int, int channel, int) { return channel < 3 || channel > 5 ? 1.0f : albedo(x); }};
  description.truth.assign(size_t{3} * kWidth * kHeight, 0.0f);
  film::Film film = make_feature_film(description);
  for (int y = 0; y < kHeight; y += 4) {
    for (int x = y / 4 % 4; x < kWidth; x += 4)
      film.components[0].primal[0][size_t(y * kWidth + x)] = Radiance(32.0f * albedo(x));
  }
  const reconstruct::Reconstructed solved = solve_with_error(film);
  const std::vector<float>&image = solved.image, &error = solved.error;
  EXPECT_TRUE(solved.components.empty());
  double light = 0.0, beside_edges = 0.0, squares = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double pixel = image[3 * (size_t(y) * kWidth + size_t(x))], value = pixel / albedo(x) / kHeight;
      squares += pixel * pixel / (kWidth * kHeight);
      light += value / kWidth;
      if (x % 12 == 0 || x % 12 == 5) beside_edges += value / (kWidth / 6);  // dark, beside bright
    }
  }
  EXPECT_GT(light, 0.95);
  EXPECT_LT(light, 1.25);
  EXPECT_NEAR(beside_edges, 1.0, 0.75);
  EXPECT_GT(mean(error), 0.9 * reconstruct::kHidden * squares);
  EXPECT_LT(mean(error), 1.25 * reconstruct::kHidden * squares);
}

TEST(B2_Regularized, DifferencesThatWereNotSampledAreThoseOfTheRegression) {
  FeatureFilm description = room(kWidth, kHeight);
  const std::vector<float> without = solve(make_feature_film(description));
  description.gradients = true;
  film::Film film = make_feature_film(description);
  for (auto& half : film.pair_count) {
    for (auto& count : half) std::fill(count.begin(), count.end(), 0.0f);
  }
  EXPECT_LT(rms_difference(solve(film), without), 2e-3);
}

// Sampled differences whose variance is that of the regression have the same weight: they restore half of the
// checkerboard.
TEST(B2_Regularized, DifferencesAreWeightedByTheirVariance) {
  FeatureFilm description = chequered(1.0f, 0.5f);
  const double variance = reconstruct::kHidden + 0.25;
  EXPECT_LT(std::abs(amplitude_of(solve(with_common_noise(description, 1.0f)))), 0.05);
  description.gradients = true;
  film::Film film = with_common_noise(description, 1.0f);
  for (int half = 0; half < film::kHalves; ++half) {
    for (const film::Offset offset : {film::kRight, film::kUp}) {
      for (Radiance& sum : film.components[0].gradient[half][offset])
        sum += Radiance(float((half == 0 ? 1.0 : -1.0) * std::sqrt(variance)));
    }
  }
  EXPECT_NEAR(amplitude_of(solve(film)), 0.25, 0.06);
}

// Regression: beside highlights, of which windows had lost some light and differences had not, pixels became black, or
// coloured where one channel did; more so where half of a difference is one sample: by chance, both half-buffers agree
// to a tenth of their error.
TEST(B2_Regularized, NoBlackHalosBesideHighlights) {
  const auto is_highlight = [](int x, int y) { return x >= 30 && x < 38 && y >= 20 && y < 26; };
  FeatureFilm description{kWidth, kHeight, {}, {}, [](int, int, int, int) { return 0.5f; }};
  description.truth =
      make_image(kWidth, kHeight, 3, [&](int x, int y, int) { return is_highlight(x, y) ? 100.0f : 0.2f; });
  description.sigma = [&](size_t i) { return is_highlight(int(i % kWidth), int(i / kWidth)) ? 40.0f : 0.05f; };
  description.gradients = true;
  for (description.seed = 1; description.seed <= 8; ++description.seed) {
    film::Film film = make_feature_film(description);
    std::mt19937 random(description.seed);
    std::normal_distribution<float> normal(0.0f, 1.0f);
    for (int y = 1; y + 1 < kHeight; ++y) {
      for (int x = 1; x + 1 < kWidth; ++x) {
        for (int o = 0; o < film::kOffsets; ++o) {
          if (is_highlight(x, y) == is_highlight(x + film::kOffsetX[o], y + film::kOffsetY[o])) continue;
          const float off = 10.0f * normal(random), seen = 1.0f * normal(random);
          for (int half = 0; half < film::kHalves; ++half) {
            film.components[0].gradient[half][o][size_t(y) * kWidth + size_t(x)] +=
                Radiance(off + (half == 0 ? seen : -seen));
          }
        }
      }
    }
    const std::vector<float> image = solve(film);
    float minimum = 1.0f;
    for (const float v : image) minimum = std::min(minimum, v);
    std::printf("  seed %u: least %.3f\n", description.seed, minimum);
    EXPECT_GT(minimum, 0.02f) << "of 0.2";
  }
}

// Regression: without differences, the planes of windows that contain a light's reflection are negative beside it. On a
// mirror, pixels became black although their samples, and those around, were not.
TEST(B2_Regularized, NoBlackPixelsBesideReflectionsOfLights) {
  const auto is_analytic = [](int x, int y) { return (x / 4) % 4 == 0 && (y / 3) % 4 == 0; };
  FeatureFilm description{kWidth, kHeight, {}, {}, [](int x, int y, int c, int) { return hashed(x, y, c, 0); }};
  description.truth =
      make_image(kWidth, kHeight, 3, [&](int x, int y, int) { return is_analytic(x, y) ? 50.0f : 0.5f; });
  description.sigma = [&](size_t i) { return is_analytic(int(i % kWidth), int(i / kWidth)) ? 20.0f : 0.1f; };
  const std::vector<float> image = solve(make_feature_film(description));
  const float minimum = *std::min_element(image.begin(), image.end());
  std::printf("  least %.3f of 0.5\n", minimum);
  EXPECT_GT(minimum, 0.05f);
}

TEST(BadInput_Regularized, ConstantFeatures) {
  FeatureFilm description = room(kWidth, kHeight);
  for (const float value : {0.0f, 1.0f, -5e3f}) {
    description.feature = [value](int, int, int, int) { return value; };
    const film::Film film = make_feature_film(description);
    EXPECT_LT(rms_difference(solve(film), description.truth), 0.8 * rms_difference(noisy(film), description.truth))
        << value;
  }
}

TEST(BadInput_Regularized, FeaturesOfNoiseAlone) {
  FeatureFilm description = room(kWidth, kHeight);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  description.feature = [&](int, int, int, int) { return uniform(random); };
  const film::Film film = make_feature_film(description);
  EXPECT_LT(rms_difference(solve(film), description.truth), rms_difference(noisy(film), description.truth));
}

TEST(BadInput_Regularized, FeaturesThatAreNotFinite) {
  const FeatureFilm description = room(kWidth, kHeight);
  film::Film film = make_feature_film(description);
  for (film::Channel& plane : film.channels) {
    plane.values[0][17 * plane.info.values_per_pixel] = std::numeric_limits<float>::quiet_NaN();
    plane.values[1][400 * plane.info.values_per_pixel] = std::numeric_limits<float>::infinity();
    plane.values[1][401 * plane.info.values_per_pixel] = 1e37f;
  }
  expect_finite_and_bounded(film, 10.0f);
  EXPECT_LT(rms_difference(solve(film), description.truth), 0.5 * rms_difference(noisy(film), description.truth));
}

// There is no surface, as in a volume: no normal, no albedo, no depth.
TEST(BadInput_Regularized, MissingFeatures) {
  FeatureFilm description = room(kWidth, kHeight);
  description.feature = [](int, int, int channel, int) { return channel < 3 ? 0.5f : 0.0f; };
  expect_finite_and_bounded(make_feature_film(description), 10.0f);
  film::Film film = make_feature_film(description);
  film.channels = {};
  reconstruct::SolveReport report;
  EXPECT_THROW(reconstruct::regularize(film, false, never, &report), Error);
}

TEST(BadInput_Regularized, ImagesSmallerThanAWindow) {
  for (const auto& [w, h] : kSizes) {
    if (w > 200) continue;
    FeatureFilm description = room(w, h);
    for (const bool gradients : {false, true}) {
      description.gradients = gradients;
      const film::Film film = make_feature_film(description);
      expect_finite_and_bounded(film, 10.0f);
      EXPECT_LT(rms_difference(solve(film), description.truth),
                1.1 * rms_difference(noisy(film), description.truth) + 1e-6)
          << w << "x" << h;
    }
  }
}

// A huge value affects only its surroundings.
TEST(BadInput_Regularized, HugeValues) {
  const FeatureFilm description = room(kWidth, kHeight);
  for (const float value : {1e6f, 1e20f, 1e36f}) {
    film::Film film = make_feature_film(description);
    film.components[0].primal[0][size_t(20 * kWidth + 30)] = Radiance(value);
    expect_finite_and_bounded(film, value);
    const std::vector<float> image = solve(film);
    double far = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 60; x < kWidth; ++x) {
        const size_t i = 3 * (size_t(y) * kWidth + size_t(x));
        far = std::max(far, std::abs(double(image[i]) - description.truth[i]));
      }
    }
    EXPECT_LT(far, 1.0) << value;
  }
}

TEST(BadInput_Regularized, ASingleSample) {
  film::Film film = make_feature_film(room(kWidth, kHeight));
  std::fill(film.count[1].begin(), film.count[1].end(), 0u);
  std::fill(film.components[0].primal[1].begin(), film.components[0].primal[1].end(), Radiance(0.0f));
  for (film::Channel& plane : film.channels) std::fill(plane.values[1].begin(), plane.values[1].end(), 0.0f);
  const std::vector<float> truth = room(kWidth, kHeight).truth;
  expect_finite_and_bounded(film, 20.0f);
  EXPECT_LT(rms_difference(solve(film), truth), 0.7 * rms_difference(noisy(film), truth));
}

// The half-buffers disagree: half the picture is in one of them alone.
TEST(BadInput_Regularized, ContradictoryHalves) {
  const FeatureFilm description = room(kWidth, kHeight);
  film::Film film = make_feature_film(description);
  for (size_t i = 0; i < size_t(kWidth) * 25; ++i) film.components[0].primal[1][i] = Radiance(0.0f);
  expect_finite_and_bounded(film, 10.0f);
}

// A film with differences that has a defect, and the maximum error of its reconstruction.
struct Defect {
  const char* name;
  std::function<float(int x, int y, int channel, int half)> feature;  // replaces that of the room
  std::function<void(film::Film*)> add_defect = [](film::Film*) {};
  // Maximum error relative to that of L2, root mean square. Where features are useless and differences as uncertain as
  // the pixels everywhere, L2 has the optimal weights by chance, and windows are smaller than its reach: 1.11 and 1.13.
  double maximum = 1.15;
};

Defect with_defect(const char* name, const std::function<void(film::Film*)>& add_defect) {
  return {name, test::room_feature, add_defect, 1.01};
}

void empty_second_half(film::Film* film) {
  std::fill(film->count[1].begin(), film->count[1].end(), 0u);
  std::fill(film->components[0].primal[1].begin(), film->components[0].primal[1].end(), Radiance(0.0f));
  for (film::Channel& plane : film->channels) std::fill(plane.values[1].begin(), plane.values[1].end(), 0.0f);
  for (int o = 0; o < film::kOffsets; ++o) {
    std::fill(film->pair_count[1][o].begin(), film->pair_count[1][o].end(), 0.0f);
    std::fill(film->components[0].gradient[1][o].begin(), film->components[0].gradient[1][o].end(), Radiance(0.0f));
  }
}

class BadInput_BesideL2 : public ::testing::TestWithParam<Defect> {};

TEST_P(BadInput_BesideL2, IsNotWorse) {
  FeatureFilm description = room(kWidth, kHeight);
  description.feature = GetParam().feature;
  description.gradients = true;
  for (const float difference_sigma : {0.0f, 0.1f, 0.5f}) {
    description.difference_sigma = difference_sigma;
    film::Film film = make_feature_film(description);
    GetParam().add_defect(&film);
    reconstruct::SolveReport report;
    const std::vector<float> l2 = reconstruct::reconstruct(film, 0, GRADUS_RECONSTRUCTION_L2, 0.0f, never, &report);
    const double error = rms_difference(solve(film), description.truth), of_l2 = rms_difference(l2, description.truth);
    std::printf("  %.1f: %.3f of L2\n", difference_sigma, error / of_l2);
    EXPECT_LE(error, GetParam().maximum * of_l2) << difference_sigma;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BadInput_BesideL2,
    ::testing::Values(Defect{"ConstantFeatures", [](int, int, int, int) { return 1.0f; }},
                      Defect{"HugeFeatures", [](int, int, int, int) { return -5e3f; }},
                      Defect{"MissingFeatures", [](int, int, int, int) { return 0.0f; }},
                      Defect{"FeaturesOfNoise",
                             [](int x, int y, int c, int half) { return 2.0f * hashed(x, y, c, half) - 1.0f; }},
                      with_defect("FeaturesThatAreNotFinite",
                                  [](film::Film* film) {
                                    for (film::Channel& plane : film->channels) {
                                      for (size_t i = 0; i < plane.values[0].size(); i += 11)
                                        plane.values[0][i] = std::numeric_limits<float>::quiet_NaN();
                                    }
                                  }),
                      with_defect("ContradictoryHalves",
                                  [](film::Film* film) {
                                    for (size_t i = 0; i < size_t(kWidth) * 25; ++i)
                                      film->components[0].primal[1][i] = Radiance(0.0f);
                                  }),
                      with_defect("HugeValues",
                                  [](film::Film* film) {
                                    film->components[0].primal[0][size_t(20 * kWidth + 30)] = Radiance(1e20f);
                                  }),
                      with_defect("ASingleSample", empty_second_half)),
    [](const auto& info) { return info.param.name; });

TEST(BadInput_Regularized, ABlackImageIsBlack) {
  FeatureFilm description = room(kWidth, kHeight);
  description.truth.assign(description.truth.size(), 0.0f);
  description.sigma = [](size_t) { return 0.0f; };
  EXPECT_EQ(solve(make_feature_film(description)), description.truth);
}

// Splits the light of the film into three components: shares that differ from pixel to pixel, no light of the last
// component in half of the picture, and in some pixels more of one component than there is.
film::Film split_into_three(const film::Film& film) {
  const auto share_of = [](size_t component, int x) {
    if (component == 1) return x < kWidth / 2 ? 0.0f : 0.25f;
    return component == 2 ? -0.5f * float(x % 2) : 1.0f - (x < kWidth / 2 ? 0.0f : 0.25f) + 0.5f * float(x % 2);
  };
  film::Film split = film;
  split.components.assign(3, film.components[0]);
  for (size_t k = 0; k < split.components.size(); ++k) {
    for (int half = 0; half < film::kHalves; ++half) {
      for (size_t i = 0; i < split.components[k].primal[half].size(); ++i) {
        const float share = share_of(k, int(i) % kWidth);
        split.components[k].primal[half][i] *= share;
        for (auto& gradient : split.components[k].gradient[half]) {
          if (!gradient.empty()) gradient[i] *= share;
        }
      }
    }
  }
  return split;
}

// Components add up to the picture, however the light was found, to the last digits of floats.
TEST(B2_Regularized, ComponentsAddUpToThePictureWithoutThem) {
  for (const bool gradients : {false, true}) {
    for (const int channels : {3, 4}) {
      FeatureFilm description = room(kWidth, kHeight);
      description.gradients = gradients;
      const film::Film film = make_feature_film(description, channels);
      reconstruct::SolveReport report;
      const reconstruct::Reconstructed whole = reconstruct::regularize(film, false, never, &report),
                                       parts = reconstruct::regularize(split_into_three(film), true, never, &report);
      ASSERT_EQ(parts.components.size(), 3u);
      for (size_t i = 0; i < whole.image.size(); ++i) {
        const float sum = parts.components[0][i] + parts.components[1][i] + parts.components[2][i];
        ASSERT_NEAR(sum, parts.image[i], 1e-5f) << i;
        ASSERT_NEAR(parts.image[i], whole.image[i], 1e-3f) << i;
      }
      EXPECT_LT(rms_difference(parts.error, whole.error), 1e-4);
    }
  }
}

// All components use one linear operator: twice the light gives twice the result, and a constant share of the picture
// stays that share.
TEST(B2_Regularized, ComponentsUseOneLinearOperator) {
  for (const bool gradients : {false, true}) {
    FeatureFilm description = room(kWidth, kHeight);
    description.gradients = gradients;
    film::Film film = make_feature_film(description);
    film.components.assign(3, film.components[0]);
    for (const auto& [component, share] : {std::pair{0, 0.2f}, {1, 0.7f}, {2, 0.1f}}) {
      for (int half = 0; half < film::kHalves; ++half) {
        for (Radiance& pixel : film.components[size_t(component)].primal[half]) pixel *= share;
        for (auto& gradient : film.components[size_t(component)].gradient[half]) {
          for (Radiance& difference : gradient) difference *= share;
        }
      }
    }
    reconstruct::SolveReport report;
    const reconstruct::Reconstructed result = reconstruct::regularize(film, true, never, &report);
    for (size_t i = 0; i < result.image.size(); ++i) {
      ASSERT_NEAR(result.components[0][i], 0.2f * result.image[i], gradients ? 2e-3f : 1e-5f);
      ASSERT_NEAR(result.components[2][i], 0.1f * result.image[i], gradients ? 2e-3f : 1e-5f);
    }
  }
}

// A component that no path has reached is black; it gets nothing of the light of others around.
TEST(B2_Regularized, AComponentWithoutLightIsBlack) {
  film::Film film = make_feature_film(room(kWidth, kHeight));
  film.components.push_back(film.components[0]);
  for (auto& half : film.components[1].primal) std::fill(half.begin(), half.end(), Radiance(0.0f));
  reconstruct::SolveReport report;
  const reconstruct::Reconstructed result = reconstruct::regularize(film, true, never, &report);
  for (const float value : result.components[1]) ASSERT_EQ(value, 0.0f);
  EXPECT_EQ(result.components[0], result.image);
}

}  // namespace
}  // namespace gradus::regularized_test
