// REGULARIZED over several frames: the windows of a picture also hold the samples of the frames around it.
#include "reconstruct/space_time/joint_regression.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "base/error.h"
#include "path/sampler.h"
#include "reconstruct/feature_film.h"
#include "reconstruct/regularized.h"
#include "reconstruct/space_time/sequences.h"
#include "support/threads.h"

namespace gradus::joint_regression_test {
namespace {

using namespace test;

constexpr int kWidth = 72, kHeight = 50, kFrames = 9, kMiddle = kFrames / 2;

// A picture whose light and features are smooth along x, so that they can move by fractions of a pixel. The light is
// linear in the features, which repeat so often that no window explains them by its coordinates.
float moving_feature(float x, int y, int channel) {
  if (channel < 3) return channel == 2 ? 1.0f : 0.0f;
  if (channel == 6) return 3.0f;
  return 0.5f + 0.25f * std::sin(0.8f * x + float(channel)) + 0.1f * std::cos(0.37f * float(y) - float(channel));
}
float moving_light(float x, int y, int channel) { return 0.3f + 2.0f * moving_feature(x, y, 3 + channel); }

// An animation. Each frame has noise of its own, and frames of the same stream have the same samples.
struct Shot {
  int frames = kFrames, channels = 3, halves = film::kHalves;
  bool gradients = false;
  float sigma = 0.4f;
  unsigned seed = 1;
  std::optional<float> pan{};  // pixels per frame of a moving picture; none: a static room
  float feature_noise = 0.0f;  // amplitude, of a static room; both halves have the same
  float ramp = 0.0f;           // increase of the light per pixel of a moving picture that no feature describes
  std::function<float(int t)> light = [](int) { return 1.0f; };
  std::function<int(int t)> stream = [](int t) { return t; };
  std::function<bool(int pixel)> linked = [](int) { return true; };

  FeatureFilm description(int t) const {
    FeatureFilm picture = test::room(kWidth, kHeight);
    if (pan) {
      const float moved = *pan * float(t);
      const float slope = ramp;
      picture.truth = make_image(kWidth, kHeight, 3, [=](int x, int y, int c) {
        return slope > 0.0f ? 1.0f + slope * (float(x) - moved) : moving_light(float(x) - moved, y, c);
      });
      picture.feature = [=](int x, int y, int channel, int) {
        return moving_feature(slope > 0.0f ? 0.0f : float(x) - moved, slope > 0.0f ? 0 : y, channel);
      };
    }
    if (feature_noise > 0.0f) {
      picture.feature = [clean = picture.feature, amplitude = feature_noise, t](int x, int y, int channel, int half) {
        const uint32_t random = path::combine(path::combine(uint32_t(t), uint32_t(channel)), uint32_t(y * kWidth + x));
        return clean(x, y, channel, half) + amplitude * (float(random) / 4294967296.0f - 0.5f);
      };
    }
    for (float& v : picture.truth) v *= light(t);
    picture.gradients = gradients;
    picture.sigma = [deviation = sigma * light(t)](size_t) { return deviation; };
    picture.seed = 1000 * seed + unsigned(stream(t));
    return picture;
  }
  std::shared_ptr<film::Film> film(int t) const {
    auto film = std::make_shared<film::Film>(make_feature_film(description(t), channels));
    for (int half = halves; half < film::kHalves; ++half) {
      std::fill(film->count[half].begin(), film->count[half].end(), 0);
      std::fill(film->components[0].primal[half].begin(), film->components[0].primal[half].end(), Radiance(0.0f));
      for (film::Channel& pass : film->channels) std::fill(pass.values[half].begin(), pass.values[half].end(), 0.0f);
    }
    return film;
  }
  reconstruct::FrameStep step(int t) const {
    reconstruct::FrameStep step{stream(t),
                                {std::vector<int32_t>(size_t(kWidth) * kHeight, film::kNoCorrespondence),
                                 std::vector<Vec2>(size_t(kWidth) * kHeight)}};
    const float moved = pan.value_or(0.0f), whole = std::round(moved);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int before = i % kWidth - int(whole);
      if (before < 0 || before >= kWidth || !linked(i)) continue;
      step.to_previous.pixel[size_t(i)] = i - int(whole);
      step.to_previous.off_centre[size_t(i)] = {moved - whole, 0.0f};
    }
    return step;
  }
  reconstruct::JointRegression regression() const {
    return {[this](int t, const CancelCheck&) { return film(t); },
            [this](int t, const CancelCheck&) { return step(t); }};
  }
  reconstruct::FrameRange all() const { return {0, frames - 1}; }
};

reconstruct::Reconstructed joint(const Shot& shot, int frame) {
  reconstruct::SolveReport report;
  reconstruct::JointRegression regression = shot.regression();
  return regression.reconstruct(frame, shot.all(), never, &report);
}
reconstruct::Reconstructed alone(const Shot& shot, int frame) {
  reconstruct::SolveReport report;
  return reconstruct::regularize(*shot.film(frame), false, never, &report, reconstruct::ErrorUse::Delivered);
}

// Returns the mean variance of a picture over its noise.
template <class Picture>
double variance_of(Shot shot, const Picture& picture) {
  constexpr unsigned kSeeds = 4;
  double variance = 0.0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    shot.seed = 2 * seed + 1;
    const std::vector<float> a = picture(shot);
    shot.seed = 2 * seed + 2;
    variance += 0.5 * std::pow(rms_difference(a, picture(shot)), 2) / kSeeds;
  }
  return variance;
}

TEST(B2_JointRegression, NineFramesLeaveASmallPartOfTheVarianceOfOne) {
  for (const bool gradients : {false, true}) {
    Shot shot;
    shot.gradients = gradients;
    const double of_all = variance_of(shot, [](const Shot&s) { return joint(s, kMiddle).image; }),
                 of_one = variance_of(shot, [](const Shot&s) { return alone(s, kMiddle).image; });
    std::printf("  gradients %d: %.4f of the variance of one frame\n", gradients, of_all / of_one);
    // With gradients, the differences of one frame are as exact as its samples are noisy.
    EXPECT_LT(of_all / of_one, gradients ? 0.4 : 2.2 / kFrames);
    EXPECT_GT(of_all / of_one, 0.7 / kFrames);
  }
}

// A denoiser reads the mean of all frames near the centres of pixels: light in the units of the film, with features.
TEST(B2_JointRegression, ReturnsTheJoinedSamples) {
  Shot shot;
  constexpr float kLight = 40.0f;
  shot.light = [](int) { return kLight; };
  const double of_one = 0.5 * std::pow(shot.sigma * kLight, 2);  // of the mean of two halves
  const auto sampled = [](const Shot& s) {
    reconstruct::SolveReport report;
    reconstruct::JointRegression regression = s.regression();
    return regression.reconstruct(kMiddle, s.all(), never, &report, {.sampled = true}).sampled;
  };
  EXPECT_NEAR(variance_of(shot, [&](const Shot& s) { return sampled(s)->light; }) / of_one, 1.0 / kFrames, 0.02);
  shot.sigma = 0.0f;
  for (const std::optional<float> pan : {std::optional<float>(), std::optional(1.0f)}) {
    shot.pan = pan;
    const auto picture = sampled(shot);
    const FeatureFilm truth = shot.description(kMiddle);
    EXPECT_LT(rms_difference(picture->light, truth.truth), 1e-4) << pan.value_or(0.0f);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      for (int c = 0; c < 3; ++c) {
        const int x = i % kWidth, y = i / kWidth;
        ASSERT_NEAR(picture->normal[size_t(3 * i + c)], truth.feature(x, y, c, 0), 0.02) << i;
        ASSERT_NEAR(picture->albedo[size_t(3 * i + c)], truth.feature(x, y, 3 + c, 0), 0.02) << i;
      }
    }
  }
  shot.frames = 1;
  reconstruct::SolveReport report;
  reconstruct::JointRegression single = shot.regression();
  EXPECT_EQ(single.reconstruct(0, shot.all(), never, &report, {.sampled = true}).sampled, nullptr);
}

// Samples lie beside the centres of pixels by fractions that differ from frame to frame. Their mean is that of a
// blurred picture, which is wrong by 0.9 % here, unless each is moved by what the picture changes.
TEST(B2_JointRegression, MovesTheLightOfADenoiserToTheCentresOfPixels) {
  constexpr unsigned kSeeds = 16;
  Shot shot;
  shot.sigma = 0.03f;
  shot.pan = 0.375f;
  const std::vector<float> truth = shot.description(kMiddle).truth;
  std::vector<float> error(truth.size(), 0.0f);
  for (shot.seed = 1; shot.seed <= kSeeds; ++shot.seed) {
    reconstruct::SolveReport report;
    reconstruct::JointRegression regression = shot.regression();
    const auto picture = regression.reconstruct(kMiddle, shot.all(), never, &report, {.sampled = true}).sampled;
    for (size_t i = 0; i < truth.size(); ++i) error[i] += (picture->light[i] / truth[i] - 1.0f) / float(kSeeds);
  }
  const double rms = rms_difference(error, std::vector<float>(error.size()));
  std::printf("  relative error %.5f\n", rms);
  EXPECT_LT(rms, 0.004);
}

// At an edge both halves of a frame may agree by chance, so that a frame by itself shows no noise in its features. The
// frames differ, and the features are filtered by what they differ.
TEST(B2_JointRegression, FiltersFeaturesByTheNoiseThatFramesShow) {
  Shot shot;
  shot.feature_noise = 0.2f;
  reconstruct::SolveReport report;
  reconstruct::JointRegression regression = shot.regression();
  const auto picture = regression.reconstruct(kMiddle, shot.all(), never, &report, {.sampled = true}).sampled;
  shot.feature_noise = 0.0f;
  const FeatureFilm truth = shot.description(kMiddle);
  double squares = 0.0;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    for (int c = 0; c < 3; ++c) {
      const double error = picture->albedo[size_t(3 * i + c)] - truth.feature(i % kWidth, i / kWidth, 3 + c, 0);
      squares += error * error / (3 * kWidth * kHeight);
    }
  }
  const double of_one = 0.2 * 0.2 / 12.0;
  std::printf("  variance over that of a frame: %.4f, of means %.4f\n", squares / of_one, 1.0 / kFrames);
  EXPECT_LT(squares / of_one, 0.5 / kFrames);
}

// Terms such as light passes are joined as the light is, but only colours are moved to the centres of pixels. Terms
// without noise stay as the picture's frame has them.
TEST(B2_JointRegression, JoinsTermsAsTheLight) {
  Shot shot;
  shot.light = [](int t) { return 1.0f + 0.01f * float(t); };
  reconstruct::JoinedOutputs wanted;
  wanted.sampled = true;
  wanted.terms = [](const film::Film& film) {
    reconstruct::HalvedImage light = reconstruct::read_sum(film), constant = light;
    for_values(&constant.half_difference, [](float& value, int, int, int) { value = 0.0f; });
    return reconstruct::SampledTerms{{light, constant}, {light.mean}};
  };
  const auto joined = [&](float pan) {
    shot.pan = pan;
    reconstruct::SolveReport report;
    reconstruct::JointRegression regression = shot.regression();
    return regression.reconstruct(kMiddle, shot.all(), never, &report, wanted);
  };
  const reconstruct::Reconstructed centred = joined(1.0f), picture = joined(0.375f);
  EXPECT_LT(rms_difference(reconstruct::interleave(centred.sampled_terms->light[0].mean), centred.sampled->light),
            1e-5);
  const reconstruct::HalvedImage own = reconstruct::read_sum(*shot.film(kMiddle)),
                                 &light = picture.sampled_terms->light[0], &constant = picture.sampled_terms->light[1];
  EXPECT_EQ(reconstruct::interleave(constant.mean), reconstruct::interleave(own.mean));
  EXPECT_EQ(reconstruct::interleave(centred.sampled_terms->colors[0]),
            reconstruct::interleave(centred.sampled_terms->light[0].mean));
  const auto rms = [](const reconstruct::Field& field) {
    return rms_difference(reconstruct::interleave(field), std::vector<float>(3 * size_t(kWidth) * kHeight));
  };
  // The displacements of 0.375 pixels and less have 0.46 to 1 of the weight.
  EXPECT_LT(rms(light.half_difference), 0.5 * rms(own.half_difference));
  EXPECT_GT(rms(light.half_difference), 0.3 * rms(own.half_difference));
}

// The noise of the picture is estimated from the half-buffers of all frames.
TEST(B2_JointRegression, EstimatesItsError) {
  double estimated = 0.0, actual = 0.0;
  Shot shot;
  for (shot.seed = 1; shot.seed <= 4; ++shot.seed) {
    const reconstruct::Reconstructed picture = joint(shot, kMiddle);
    estimated += mean(picture.error);
    actual += std::pow(rms_difference(picture.image, shot.description(kMiddle).truth), 2);
  }
  std::printf("  estimated error: %.3f of the actual one\n", estimated / actual);
  EXPECT_GT(estimated / actual, 1.0);
  EXPECT_LT(estimated / actual, 3.0);
}

// A static scene flickers less than its frames by themselves.
TEST(B2_JointRegression, SuccessivePicturesDifferLittle) {
  const Shot shot;
  const double joined = rms_difference(joint(shot, 3).image, joint(shot, 4).image),
               each = rms_difference(alone(shot, 3).image, alone(shot, 4).image);
  std::printf("  flicker: %.4f of that of single frames\n", joined * joined / (each * each));
  EXPECT_LT(joined * joined, 0.12 * each * each);
}

// There is no lag and no ghost.
TEST(C5_JointRegression, ALightThatGoesOffIsDarkAtOnce) {
  constexpr int kFirstDark = 5;
  Shot shot;
  shot.light = [](int t) { return t < kFirstDark ? 1.0f : 0.0f; };
  const double bright = mean(shot.description(0).truth);
  for (int t = 2; t < kFrames - 1; ++t) {
    const double share = mean(joint(shot, t).image) / bright, own = mean(alone(shot, t).image) / bright;
    std::printf("  frame %d: %.5f of the light, %.5f by itself\n", t, share, own);
    EXPECT_NEAR(share, t < kFirstDark ? 1.0 : 0.0, t < kFirstDark ? 0.01 : 1e-3) << t;
  }
}

TEST(C5_JointRegression, AChangeOfTheLightShowsAtOnce) {
  for (const auto& [before, after] : {std::pair(1.0f, 0.1f), std::pair(0.1f, 1.0f), std::pair(1.0f, 0.7f)}) {
    Shot shot;
    shot.light = [before = before, after = after](int t) { return t < kMiddle ? before : after; };
    for (const int t : {kMiddle - 1, kMiddle}) {
      const std::vector<float> truth = shot.description(t).truth, picture = joint(shot, t).image;
      EXPECT_NEAR(mean(picture) / mean(truth), 1.0, 0.02) << t;
      EXPECT_LT(rms_difference(picture, truth), rms_difference(alone(shot, t).image, truth)) << t;
    }
  }
}

// Returns the squared bias of a picture, from the errors of two sets of pictures with other noise. Pixels that the pan
// moves out of some frames are left out.
double squared_bias(Shot shot, int frame) {
  constexpr int kBorder = 8;
  constexpr unsigned kSeeds = 8;
  const std::vector<float> truth = shot.description(frame).truth;
  std::vector<double> errors[2];
  for (unsigned set = 0; set < 2; ++set) {
    errors[set].assign(truth.size(), 0.0);
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      shot.seed = 100 * set + seed;
      const std::vector<float> picture = joint(shot, frame).image;
      for (size_t i = 0; i < truth.size(); ++i) errors[set][i] += double(picture[i] - truth[i]) / kSeeds;
    }
  }
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    const int x = int(i / 3) % kWidth;
    if (x < kBorder || x >= kWidth - kBorder) continue;
    sum += errors[0][i] * errors[1][i];
    ++count;
  }
  return sum / count;
}

// Samples count at their places, with the features that they have there.
TEST(B2_JointRegression, APanByAFractionOfAPixelHasNoBias) {
  Shot shot;
  shot.sigma = 0.2f;
  for (const float pan : {0.0f, 0.375f, -0.5f, 1.25f}) {
    shot.pan = pan;
    const double bias = squared_bias(shot, kMiddle),
                 variance = variance_of(shot, [](const Shot&s) { return joint(s, kMiddle).image; });
    std::printf("  pan %g: squared bias %.3e, variance %.3e\n", double(pan), bias, variance);
    EXPECT_LT(bias, 0.25 * variance) << pan;
  }
}

// All samples of the other frame lie on one side of the centres of their pixels. Taken there, they shift the picture,
// or the test of light leaves them out, and there is as much noise as in one frame.
TEST(B2_JointRegression, DisplacementsCountInWindows) {
  Shot shot;
  shot.frames = 2;
  shot.pan = 0.45f;
  shot.ramp = 0.05f;
  shot.sigma = 0.02f;
  for (const int frame : {0, 1}) {
    const std::vector<float> truth = shot.description(frame).truth;
    double shift = 0.0, error = 0.0, of_one = 0.0;
    constexpr unsigned kSeeds = 4;
    for (shot.seed = 1; shot.seed <= kSeeds; ++shot.seed) {
      const std::vector<float> picture = joint(shot, frame).image;
      shift += (mean(picture) - mean(truth)) / double(shot.ramp) / kSeeds;
      error += std::pow(rms_difference(picture, truth), 2);
      of_one += std::pow(rms_difference(alone(shot, frame).image, truth), 2);
    }
    std::printf("  frame %d: shifted by %.4f pixels, %.3f of the squared error of one frame\n", frame, shift,
                error / of_one);
    EXPECT_NEAR(shift, 0.0, 0.02) << frame;
    EXPECT_LT(error, 0.85 * of_one) << frame;
  }
}

// Weights by noise give rare bright samples too little weight; all samples together know how much light that is.
TEST(B2_JointRegression, KeepsTheLightOfRareBrightSamples) {
  Shot shot;
  double sampled = 0.0;
  const auto with_bright_samples = [&](int t) {
    std::shared_ptr<film::Film> film = shot.film(t);
    auto& half = film->components[0].primal[t % film::kHalves];
    for (size_t i = size_t(13 * t) % 101; i < half.size(); i += 101) half[i] += Radiance(60.0f);
    return film;
  };
  for (int t = 0; t < shot.frames; ++t) {
    const film::Film film = *with_bright_samples(t);
    for (size_t i = 0; i < film.count[0].size(); ++i) {
      const float samples = float(film.count[0][i]) + float(film.count[1][i]);
      for (int c = 0; c < 3; ++c)
        sampled += (Rgb(film.components[0].primal[0][i])[c] + Rgb(film.components[0].primal[1][i])[c]) / samples;
    }
  }
  sampled /= double(shot.frames) * kWidth * kHeight * 3;
  reconstruct::SolveReport report;
  reconstruct::JointRegression regression([&](int t, const CancelCheck&) { return with_bright_samples(t); },
                                          [&](int t, const CancelCheck&) { return shot.step(t); });
  const std::vector<float> picture = regression.reconstruct(kMiddle, shot.all(), never, &report).image;
  EXPECT_NEAR(mean(picture) / sampled, 1.0, 0.02);
}

// Returns the film of a frame with its light in two components, the second brighter to the right.
std::shared_ptr<film::Film> in_two_components(const Shot& shot, int t) {
  std::shared_ptr<film::Film> film = shot.film(t);
  film->components.push_back(film->components[0]);
  for (size_t k = 0; k < 2; ++k) {
    for (auto& half : film->components[k].primal) {
      for (size_t i = 0; i < half.size(); ++i) {
        const float second = 0.1f + 0.3f * float(i % kWidth) / kWidth;
        half[i] *= k == 1 ? second : 1.0f - second;
      }
    }
  }
  return film;
}

reconstruct::Reconstructed joint_components(const Shot& shot, int frame) {
  reconstruct::SolveReport report;
  reconstruct::JointRegression regression([&](int t, const CancelCheck&) { return in_two_components(shot, t); },
                                          [&](int t, const CancelCheck&) { return shot.step(t); });
  return regression.reconstruct(frame, shot.all(), never, &report, {.components = true});
}

// All components go through the operator of their sum.
TEST(B2_JointRegression, ComponentsAddUpToThePicture) {
  for (const std::optional<float> pan : {std::optional<float>{}, std::optional<float>{0.375f}}) {
    Shot shot;
    shot.pan = pan;
    shot.frames = 5;
    shot.light = [](int t) { return 1.0f + 0.02f * float(t); };
    const reconstruct::Reconstructed whole = joint(shot, 2), parts = joint_components(shot, 2);
    ASSERT_EQ(parts.components.size(), 2u);
    EXPECT_LT(rms_difference(parts.image, whole.image), 1e-4);
    EXPECT_LT(rms_difference(parts.error, whole.error), 1e-4);
    for (size_t i = 0; i < whole.image.size(); ++i)
      ASSERT_NEAR(parts.components[0][i] + parts.components[1][i], parts.image[i], 1e-5f) << i;
  }
}

// The second component is taken from the samples of all frames, too.
TEST(B2_JointRegression, ComponentsHaveTheSamplesOfAllFrames) {
  const Shot shot;
  const double of_all = variance_of(shot, [](const Shot& s) { return joint_components(s, kMiddle).components[1]; });
  const double of_one = variance_of(shot, [](const Shot& s) {
    reconstruct::SolveReport report;
    return reconstruct::regularize(*in_two_components(s, kMiddle), true, never, &report).components[1];
  });
  std::printf("  second component: %.4f of the variance of one frame\n", of_all / of_one);
  EXPECT_LT(of_all / of_one, 0.3);
}

// Alpha, which is an eighth of red in these films, uses the weights of the colours.
// But for the light that weights by noise lose, which is restored in the colours alone.
TEST(B2_JointRegression, AlphaUsesTheWeightsOfTheColours) {
  for (const int every : {1, 4}) {
    Shot shot;
    shot.channels = 4;
    shot.frames = 5;
    shot.light = [](int t) { return 1.0f + 0.05f * float(t); };
    shot.linked = [every](int pixel) { return pixel % kWidth % every == 0; };
    const std::vector<float> picture = joint(shot, 2).image;
    for (size_t i = 0; i < picture.size(); i += 4) ASSERT_NEAR(8.0f * picture[i + 3], picture[i], 1e-2f) << i / 4;
  }
}

TEST(B2_JointRegression, WithoutCorrespondencesItIsThePictureOfOneFrame) {
  Shot shot;
  shot.frames = 5;
  shot.linked = [](int) { return false; };
  const reconstruct::Reconstructed joined = joint(shot, 2), single = alone(shot, 2);
  EXPECT_LT(rms_difference(joined.image, single.image), 1e-5);
  EXPECT_LT(rms_difference(joined.error, single.error), 1e-5);
}

// Frames that are repeated have the same samples, which count once.
TEST(B2_JointRegression, RepeatedFramesCountOnce) {
  Shot shot;
  shot.stream = [](int) { return 0; };
  EXPECT_EQ(joint(shot, kMiddle).image, alone(shot, kMiddle).image);
  Shot repeated, once;
  once.stream = [](int t) { return 2 * t; };
  once.frames = 3;
  repeated.stream = [](int t) { return t / 2 * 2; };
  repeated.frames = 6;
  const std::vector<float> expected = joint(once, 1).image;
  for (const int frame : {2, 3}) EXPECT_EQ(joint(repeated, frame).image, expected) << frame;
}

// Lights of any strength.
TEST(B2_JointRegression, ScalesWithTheLight) {
  Shot shot;
  shot.frames = 3;
  const std::vector<float> picture = joint(shot, 1).image;
  for (const float strength : {1e-18f, 1e-10f, 1e10f, 1e18f}) {
    shot.light = [strength](int) { return strength; };
    const std::vector<float> scaled = joint(shot, 1).image;
    for (size_t i = 0; i < picture.size(); ++i) {
      // Beyond the range of floats, squares no longer order the errors.
      ASSERT_NEAR(scaled[i] / strength, picture[i], strength < 1e-15f || strength > 1e15f ? 0.5f : 0.01f) << strength;
    }
  }
}

// With one sample per pixel the noise is unknown.
TEST(B2_JointRegression, AcceptsFramesWithoutASecondHalf) {
  Shot shot;
  shot.halves = 1;
  const std::vector<float> picture = joint(shot, kMiddle).image, truth = shot.description(kMiddle).truth;
  for (const float value : picture) ASSERT_TRUE(std::isfinite(value));
  EXPECT_LT(rms_difference(picture, truth), rms_difference(alone(shot, kMiddle).image, truth));
}

// A job that begins in the middle of a sequence has the pictures of the whole, if it has the same neighbours. Every
// frame is opened once.
TEST(B2_JointRegression, APartHasThePicturesOfTheWhole) {
  Shot shot;
  shot.frames = 8;
  shot.pan = 0.375f;
  const auto around = [&](int t) {
    return reconstruct::FrameRange{std::max(t - 2, 0), std::min(t + 2, shot.frames - 1)};
  };
  reconstruct::SolveReport report;
  std::map<int, int> opened;
  reconstruct::JointRegression whole(
      [&](int t, const CancelCheck&) {
        ++opened[t];
        return shot.film(t);
      },
      [&](int t, const CancelCheck&) { return shot.step(t); });
  std::vector<reconstruct::Reconstructed> pictures;
  for (int t = 0; t < shot.frames; ++t) pictures.push_back(whole.reconstruct(t, around(t), never, &report));
  for (int t = 0; t < shot.frames; ++t) EXPECT_EQ(opened[t], 1) << t;
  for (const int first : {3, 6}) {
    reconstruct::JointRegression part = shot.regression();
    for (int t = first; t < shot.frames; ++t) {
      const reconstruct::Reconstructed picture = part.reconstruct(t, around(t), never, &report);
      EXPECT_EQ(picture.image, pictures[size_t(t)].image) << t;
      EXPECT_EQ(picture.error, pictures[size_t(t)].error) << t;
    }
  }
}

TEST(B2_JointRegression, HasTheSameBitsForAnyNumberOfThreads) {
  Shot shot;
  shot.frames = 3;
  shot.pan = 0.375f;
  shot.channels = 4;
  expect_same_bits_for_any_number_of_threads([&] { return joint(shot, 1).image; });
}

TEST(K1_JointRegression, ReturnsNothingWhenCancelled) {
  Shot shot;
  shot.frames = 3;
  reconstruct::SolveReport report;
  std::atomic<int> checks{0};
  reconstruct::JointRegression counted = shot.regression();
  counted.reconstruct(
      1, shot.all(), [&] { return ++checks < 0; }, &report);
  EXPECT_GT(checks, 2 * shot.frames);
  for (const int last : {0, 1, shot.frames, checks / 2, checks - 1}) {
    std::atomic<int> left{last};
    reconstruct::JointRegression regression = shot.regression();
    const reconstruct::Reconstructed picture = regression.reconstruct(
        1, shot.all(), [&] { return --left < 0; }, &report);
    EXPECT_TRUE(last > shot.frames || picture.image.empty()) << last;
  }
}

}  // namespace
}  // namespace gradus::joint_regression_test
