// REGULARIZED over time: reconstructions of single frames are combined along the tracks of their pixels.
#include "reconstruct/space_time/regularized_windows.h"

#include <numeric>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "animation/frame_window.h"
#include "base/error.h"
#include "reconstruct/feature_film.h"
#include "reconstruct/regularized.h"
#include "reconstruct/space_time/sequences.h"
#include "reconstruct/space_time/solve_tracks.h"
#include "render/resume.h"
#include "support/threads.h"

namespace gradus::regularized_windows_test {
namespace {

using namespace test;

constexpr int kWidth = 72, kHeight = 50;

// Returns the sources of a single component.
reconstruct::ComponentSources alone(std::unique_ptr<reconstruct::HalvedWindowSource> source) {
  reconstruct::ComponentSources sources;
  sources.push_back(std::move(source));
  return sources;
}

// A room that is sampled like the frames of an animation: with fresh random numbers, and with those of the frame
// before. The camera is static; the light has the strength light(t).
struct Shot {
  int frames = 6, channels = 3, halves = film::kHalves;
  std::function<float(int t)> light = [](int) { return 1.0f; };
  std::function<bool(int pixel)> linked = [](int) { return true; };
  bool gradients = false;
  float replay_sigma = 0.02f;  // deviation between the noise of a replay and that of the replayed samples

  FeatureFilm description(int t) const {
    FeatureFilm room = test::room(kWidth, kHeight);
    for (float& v : room.truth) v *= light(t);
    room.gradients = gradients;
    room.sigma = [](size_t) { return 0.0f; };
    return room;
  }
  // Returns the samples of frame t with the random numbers of frame `stream`.
  film::Film sampled(int t, int stream) const {
    film::Film film = make_feature_film(description(t), channels);
    std::mt19937 random(unsigned(stream) + 11), other(unsigned(1000 + t));
    std::normal_distribution<float> noise(0.0f, 0.4f), replay_noise(0.0f, replay_sigma);
    for (auto& half : film.components[0].primal) {
      for (Radiance& pixel : half) {
        for (int c = 0; c < 3; ++c) pixel[c] += light(t) * noise(random) + (t != stream ? replay_noise(other) : 0.0f);
        if (channels == 4) pixel[3] = pixel[0] / 8.0f;
      }
    }
    for (int half = halves; half < film::kHalves; ++half) remove(half, &film);
    return film;
  }
  static void remove(int half, film::Film* film) {
    std::fill(film->count[half].begin(), film->count[half].end(), 0);
    std::fill(film->components[0].primal[half].begin(), film->components[0].primal[half].end(), Radiance(0.0f));
    for (film::Channel& pass : film->channels) std::fill(pass.values[half].begin(), pass.values[half].end(), 0.0f);
  }
  std::shared_ptr<const film::Film> merged(int t) const {
    auto film = std::make_shared<film::Film>(sampled(t, t));
    render::merge_films(film.get(), sampled(t, t - 1));
    return film;
  }
  std::shared_ptr<const animation::TemporalFrame> temporal(int t) const {
    auto film =
        std::make_shared<animation::TemporalFrame>(animation::make_temporal_frame(sampled(t, t), sampled(t, t - 1)));
    film->stream = t;
    film->replayed = {t - 1, {std::vector<int32_t>(size_t(kWidth) * kHeight)}};
    for (int i = 0; i < kWidth * kHeight; ++i)
      film->replayed.correspondence.pixel[size_t(i)] = linked(i) ? i : film::kNoCorrespondence;
    return film;
  }
  std::unique_ptr<reconstruct::HalvedWindowSource> pair(int t) const {
    return std::make_unique<animation::FrameWindow>(
        std::vector<std::shared_ptr<const animation::TemporalFrame>>{temporal(t), temporal(t + 1)});
  }
  reconstruct::RegularizedWindows::OpenFilm open() const {
    return [this](int t, const CancelCheck&) { return merged(t); };
  }
  reconstruct::RegularizedWindows::OpenDifferences differences() const {
    return [this](int t, const CancelCheck&) { return alone(pair(t)); };
  }
  reconstruct::RegularizedWindows windows() const { return {open(), differences()}; }
  reconstruct::FrameRange all() const { return {0, frames - 1}; }
};

std::vector<reconstruct::Reconstructed> solve(reconstruct::RegularizedWindows* windows,
                                              const reconstruct::FrameRange& range) {
  reconstruct::SolveReport report;
  std::vector<reconstruct::Reconstructed> pictures;
  windows->reconstruct(range, never, &report, [&](int t, reconstruct::Reconstructed picture) {
    EXPECT_EQ(t, int(pictures.size()));
    pictures.push_back(std::move(picture));
  });
  return pictures;
}
std::vector<reconstruct::Reconstructed> solve(const Shot& shot) {
  reconstruct::RegularizedWindows windows = shot.windows();
  return solve(&windows, shot.all());
}
std::vector<reconstruct::Reconstructed> solve_each(const Shot& shot) {
  reconstruct::SolveReport report;
  std::vector<reconstruct::Reconstructed> pictures;
  for (int t = 0; t < shot.frames; ++t)
    pictures.push_back(reconstruct::regularize(*shot.merged(t), false, never, &report));
  return pictures;
}

double error_of(const Shot& shot, const std::vector<reconstruct::Reconstructed>& pictures) {
  double squares = 0.0;
  for (int t = 0; t < shot.frames; ++t)
    squares += std::pow(rms_difference(pictures[size_t(t)].image, shot.description(t).truth), 2);
  return squares / shot.frames;
}
double flicker_of(const std::vector<reconstruct::Reconstructed>& pictures) {
  double squares = 0.0;
  for (size_t t = 1; t < pictures.size(); ++t)
    squares += std::pow(rms_difference(pictures[t].image, pictures[t - 1].image), 2);
  return squares / double(pictures.size() - 1);
}

TEST(B2_Tracks, EqualTheDenseSolution) {
  constexpr int w = 7, h = 5, frames = 4, pixels = w * h, unknowns = pixels * frames;
  for (const Motion motion : kMotions) {
    Window window(w, h, 2, frames);
    set_correspondences(&window, motion);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0.01f, 2.0f);
    const auto random_fields = [&](int count, int channels) {
      std::vector<reconstruct::Field> fields(size_t(count), reconstruct::Field(w, h, channels));
      for (reconstruct::Field& field : fields) {
        for (int y = 0; y < h; ++y)
          for (int c = 0; c < channels; ++c)
            for (int x = 0; x < w; ++x) field.row(y, c)[x] = uniform(random);
      }
      return fields;
    };
    std::vector<reconstruct::Field> values = random_fields(frames, 2), weights = random_fields(frames, 1);
    const std::vector<reconstruct::Field> differences = random_fields(frames - 1, 1),
                                          couplings = random_fields(frames - 1, 1);
    std::vector<reconstruct::CorrespondenceMap> correspondence;
    for (int t = 0; t + 1 < frames; ++t) correspondence.push_back(reconstruct::read_correspondence(window, t));
    for (const int channel : {0, 1}) {  // the second channel has no differences: they are 0
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
      for (int i = 0; i < unknowns; ++i) {
        const int t = i / pixels, y = i % pixels / w, x = i % w;
        const double weight = weights[size_t(t)].row(y)[x];
        matrix(i, i) += weight;
        right[i] += weight * values[size_t(t)].row(y, channel)[x];
        const int there = window.correspondence[size_t(t)][size_t(i % pixels)];
        if (t + 1 == frames || there == film::kNoCorrespondence) continue;
        const int j = (t + 1) * pixels + there;
        const double c = couplings[size_t(t)].row(y)[x], d = channel == 0 ? differences[size_t(t)].row(y)[x] : 0.0;
        matrix(i, i) += c;
        matrix(j, j) += c;
        matrix(i, j) -= c;
        matrix(j, i) -= c;
        right[i] -= c * d;
        right[j] += c * d;
      }
      const Eigen::VectorXd expected = matrix.ldlt().solve(right);
      std::vector<reconstruct::Field> x = values, used = weights;
      std::vector<reconstruct::TrackStep> steps;
      for (size_t t = 0; t + 1 < frames; ++t) steps.push_back({correspondence[t], differences[t], couplings[t]});
      reconstruct::solve_tracks(steps, &x, &used);
      for (int i = 0; i < unknowns; ++i) {
        ASSERT_NEAR(x[size_t(i / pixels)].row(i % pixels / w, channel)[i % w], expected[i], 1e-4)
            << i << ", motion " << int(motion);
      }
    }
  }
}

TEST(B2_RegularizedWindow, HasLessErrorAndFarLessFlickerThanItsFrames) {
  for (const bool gradients : {false, true}) {
    Shot shot;
    shot.gradients = gradients;
    const std::vector<reconstruct::Reconstructed> joined = solve(shot), each = solve_each(shot);
    EXPECT_LT(error_of(shot, joined), 0.6 * error_of(shot, each));
    EXPECT_LT(flicker_of(joined), 0.1 * flicker_of(each));
  }
}

// A static scene whose replays have the same noise is the same picture in all frames.
TEST(B2_RegularizedWindow, OfAStaticSceneDoesNotFlicker) {
  Shot shot;
  shot.replay_sigma = 0.0f;
  const std::vector<reconstruct::Reconstructed> pictures = solve(shot);
  EXPECT_LT(std::sqrt(flicker_of(pictures)), 2e-3);
}

TEST(B2_RegularizedWindow, WithoutCorrespondencesPixelsKeepTheirStillPicture) {
  Shot shot;
  shot.frames = 3;
  shot.linked = [](int pixel) { return pixel % kWidth >= kWidth / 2; };
  const std::vector<reconstruct::Reconstructed> joined = solve(shot), each = solve_each(shot);
  for (size_t t = 0; t < joined.size(); ++t) {
    int changed = 0;
    for (size_t i = 0; i < each[t].image.size(); ++i) {
      const bool linked = shot.linked(int(i / 3));
      if (linked) {
        changed += joined[t].image[i] != each[t].image[i];
        continue;
      }
      ASSERT_EQ(joined[t].image[i], each[t].image[i]);
      ASSERT_EQ(joined[t].error[i / 3], each[t].error[i / 3]);
    }
    EXPECT_GT(changed, kWidth * kHeight);
  }
}

// There is no lag and no ghost: the change of the light was sampled.
TEST(C5_RegularizedWindow, ALightThatIsSwitchedOnShowsAtOnce) {
  for (const auto& [before, after] : {std::pair(1.0f, 0.1f), std::pair(0.1f, 1.0f)}) {
    Shot shot;
    shot.light = [before = before, after = after](int t) { return t < 3 ? before : after; };
    const std::vector<reconstruct::Reconstructed> pictures = solve(shot), each = solve_each(shot);
    for (int t = 0; t < shot.frames; ++t) {
      const std::vector<float> truth = shot.description(t).truth;
      EXPECT_NEAR(mean(pictures[size_t(t)].image) / mean(truth), 1.0, 0.02) << t;
      EXPECT_LT(rms_difference(pictures[size_t(t)].image, truth), 1.2 * rms_difference(each[size_t(t)].image, truth))
          << t;
    }
  }
}

// A source that claims, with certainty, that nothing changes.
class ClaimsNoChange final : public reconstruct::HalvedWindowSource {
 public:
  explicit ClaimsNoChange(std::unique_ptr<reconstruct::HalvedWindowSource> window) : window_(std::move(window)) {}
  reconstruct::WindowSize size() const override { return window_->size(); }
  void read_row(reconstruct::RowKind, int, int, float* out) const override { read(out); }
  void read_half_differences(reconstruct::RowKind, int, int, float* out) const override { read(out); }
  void read_correspondence(int t, int y, int32_t* out) const override { window_->read_correspondence(t, y, out); }

 private:
  void read(float* out) const { std::fill_n(out, size_t(size().width) * size_t(size().channels), 0.0f); }
  std::unique_ptr<reconstruct::HalvedWindowSource> window_;
};

// Samples of both frames outweigh a wrong change that claims to be certain.
TEST(C5_RegularizedWindow, AWrongChangeLeavesNoGhost) {
  Shot shot;
  shot.light = [](int t) { return t < 3 ? 1.0f : 0.1f; };
  reconstruct::SolveReport report;
  reconstruct::RegularizedWindows windows(
      shot.open(), [&](int t, const CancelCheck&) { return alone(std::make_unique<ClaimsNoChange>(shot.pair(t))); });
  windows.reconstruct(shot.all(), never, &report, [&](int t, const reconstruct::Reconstructed& picture) {
    EXPECT_NEAR(mean(picture.image) / mean(shot.description(t).truth), 1.0, 0.05) << t;
  });
}

// Alpha, which is an eighth of red in these films, uses the weights of the colours.
TEST(B2_RegularizedWindow, AlphaUsesTheWeightsOfTheColours) {
  Shot shot;
  shot.channels = 4;
  shot.frames = 3;
  shot.light = [](int t) { return 1.0f + 0.2f * float(t); };
  for (const reconstruct::Reconstructed& picture : solve(shot)) {
    for (size_t i = 0; i < picture.image.size(); i += 4)
      ASSERT_NEAR(8.0f * picture.image[i + 3], picture.image[i], 4e-3f) << i / 4;
  }
}

// Regression: disocclusions of the colours were filled, those of alpha were 0, so that the rest did not change.
TEST(B2_RegularizedWindow, AlphaBesideDisocclusionsUsesTheWeightsOfTheColours) {
  Shot shot;
  shot.channels = 4;
  shot.frames = 3;
  shot.light = [](int t) { return 1.0f + 0.2f * float(t); };
  shot.linked = [](int pixel) { return pixel % kWidth % 4 == 0; };
  for (const reconstruct::Reconstructed& picture : solve(shot)) {
    for (size_t i = 0; i < picture.image.size(); i += 4)
      ASSERT_NEAR(8.0f * picture.image[i + 3], picture.image[i], 4e-3f) << i / 4;
  }
}

// Lights of any strength.
TEST(B2_RegularizedWindow, ScalesWithTheLight) {
  Shot shot;
  shot.frames = 3;
  const std::vector<reconstruct::Reconstructed> pictures = solve(shot);
  for (const float strength : {1e-18f, 1e-10f, 1e10f, 1e18f}) {
    shot.light = [strength](int) { return strength; };
    shot.replay_sigma = 0.02f * strength;
    const std::vector<reconstruct::Reconstructed> scaled = solve(shot);
    for (size_t t = 0; t < pictures.size(); ++t) {
      for (size_t i = 0; i < pictures[t].image.size(); ++i) {
        const float value = scaled[t].image[i] / strength;
        // Beyond the range of floats, squares no longer order the errors.
        ASSERT_NEAR(value, pictures[t].image[i], strength < 1e-15f || strength > 1e15f ? 0.5f : 0.01f) << strength;
      }
    }
  }
}

// One of two samples is a replay: the noise is unknown.
TEST(B2_RegularizedWindow, AcceptsFramesWithoutASecondHalf) {
  Shot shot;
  shot.halves = 1;
  const std::vector<reconstruct::Reconstructed> pictures = solve(shot), each = solve_each(shot);
  for (const reconstruct::Reconstructed& picture : pictures) {
    for (const float value : picture.image) ASSERT_TRUE(std::isfinite(value));
  }
  EXPECT_LT(error_of(shot, pictures), error_of(shot, each));
}

// Frames that two windows share are read and reconstructed once. The result is that of a window by itself.
TEST(B2_RegularizedWindow, SharesFramesWithTheWindowBefore) {
  Shot shot;
  shot.frames = 8;
  std::map<int, int> opened;
  std::map<int, int> changes;
  reconstruct::RegularizedWindows both(
      [&](int t, const CancelCheck&) {
        ++opened[t];
        return shot.merged(t);
      },
      [&](int t, const CancelCheck&) {
        ++changes[t];
        return alone(shot.pair(t));
      });
  solve(&both, {0, 4});
  const std::vector<reconstruct::Reconstructed> second = solve(&both, {3, 7});
  EXPECT_EQ(opened, (std::map<int, int>{{0, 1}, {1, 1}, {2, 1}, {3, 1}, {4, 1}, {5, 1}, {6, 1}, {7, 1}}));
  EXPECT_EQ(changes, (std::map<int, int>{{0, 1}, {1, 1}, {2, 1}, {3, 1}, {4, 1}, {5, 1}, {6, 1}}));
  reconstruct::RegularizedWindows alone = shot.windows();
  const std::vector<reconstruct::Reconstructed> expected = solve(&alone, {3, 7});
  ASSERT_EQ(second.size(), expected.size());
  for (size_t t = 0; t < expected.size(); ++t) {
    EXPECT_EQ(second[t].image, expected[t].image) << t;
    EXPECT_EQ(second[t].error, expected[t].error) << t;
  }
}

TEST(B2_RegularizedWindow, HasTheSameBitsForAnyNumberOfThreads) {
  Shot shot;
  shot.frames = 3;
  expect_same_bits_for_any_number_of_threads([&] { return solve(shot).back().image; });
}

TEST(B2_RegularizedWindow, ReturnsNothingWhenCancelled) {
  Shot shot;
  shot.frames = 2;
  reconstruct::SolveReport report;
  reconstruct::RegularizedWindows windows = shot.windows();
  windows.reconstruct(
      shot.all(), [] { return true; }, &report, [](int, const reconstruct::Reconstructed&) { ADD_FAILURE(); });
}

TEST(B2_RegularizedWindow, RefusesFramesOfAnotherSize) {
  Shot shot;
  shot.frames = 2;
  Shot other = shot;
  other.channels = 4;
  reconstruct::SolveReport report;
  reconstruct::RegularizedWindows windows(other.open(), shot.differences());
  EXPECT_THROW(windows.reconstruct(shot.all(), never, &report, [](int, const reconstruct::Reconstructed&) {}), Error);
}

// The light of a shot in two components, the second brighter to the right.
struct TwoComponents {
  Shot shot;
  bool second_has_correspondence = true;

  static void split_by_position(film::Film* film) {
    film->components.push_back(film->components[0]);
    for (size_t k = 0; k < 2; ++k) {
      for (auto& half : film->components[k].primal) {
        for (size_t i = 0; i < half.size(); ++i) {
          const float second = 0.1f + 0.3f * float(i % kWidth) / kWidth;
          half[i] *= k == 1 ? second : 1.0f - second;
        }
      }
    }
  }
  std::shared_ptr<const film::Film> merged(int t) const {
    auto film = std::make_shared<film::Film>(*shot.merged(t));
    split_by_position(film.get());
    return film;
  }
  std::shared_ptr<const animation::TemporalFrame> temporal(int t, int component) const {
    film::Film base = shot.sampled(t, t), replay = shot.sampled(t, t - 1);
    split_by_position(&base);
    split_by_position(&replay);
    auto film = std::make_shared<animation::TemporalFrame>(animation::make_temporal_frame(base, replay, {}, component));
    film->stream = t;
    film->replayed = shot.temporal(t)->replayed;
    if (component == 1 && !second_has_correspondence)
      std::ranges::fill(film->replayed.correspondence.pixel, film::kNoCorrespondence);
    return film;
  }
  reconstruct::RegularizedWindows windows() const {
    return {[this](int t, const CancelCheck&) { return merged(t); },
            [this](int t, const CancelCheck&) {
              reconstruct::ComponentSources sources;
              for (int k = 0; k < 2; ++k) {
                sources.push_back(std::make_unique<animation::FrameWindow>(
                    std::vector<std::shared_ptr<const animation::TemporalFrame>>{temporal(t, k), temporal(t + 1, k)}));
              }
              return sources;
            }};
  }
};

// Decomposition alone changes nothing.
TEST(B2_RegularizedWindow, ComponentsWithTheSameDisplacementsAddUpToTheirSum) {
  TwoComponents two;
  two.shot.frames = 4;
  two.shot.light = [](int t) { return 1.0f + 0.1f * float(t); };
  reconstruct::RegularizedWindows windows = two.windows();
  const std::vector<reconstruct::Reconstructed> parts = solve(&windows, two.shot.all()), whole = solve(two.shot);
  for (size_t t = 0; t < whole.size(); ++t) {
    ASSERT_EQ(parts[t].components.size(), 2u);
    EXPECT_LT(rms_difference(parts[t].image, whole[t].image), 1e-4) << t;
    EXPECT_LT(rms_difference(parts[t].error, whole[t].error), 1e-4) << t;
    for (size_t i = 0; i < whole[t].image.size(); ++i) {
      ASSERT_NEAR(parts[t].components[0][i] + parts[t].components[1][i], parts[t].image[i], 1e-5f);
    }
  }
}

// A component without correspondences has the pictures of single frames; the other one follows its own tracks.
TEST(B2_RegularizedWindow, EveryComponentFollowsItsOwnDisplacements) {
  TwoComponents two;
  two.shot.frames = 5;
  two.second_has_correspondence = false;
  reconstruct::RegularizedWindows windows = two.windows();
  const std::vector<reconstruct::Reconstructed> parts = solve(&windows, two.shot.all());
  double linked = 0.0, still = 0.0;
  for (int t = 0; t < two.shot.frames; ++t) {
    reconstruct::SolveReport report;
    const reconstruct::Reconstructed each = reconstruct::regularize(*two.merged(t), true, never, &report);
    EXPECT_EQ(parts[size_t(t)].components[1], each.components[1]) << t;
    if (t == 0) continue;
    linked += rms_difference(parts[size_t(t)].components[0], parts[size_t(t) - 1].components[0]);
    still += rms_difference(each.components[0],
                            reconstruct::regularize(*two.merged(t - 1), true, never, &report).components[0]);
  }
  EXPECT_LT(linked, 0.5 * still);
}

}  // namespace
}  // namespace gradus::regularized_windows_test
