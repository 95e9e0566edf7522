// Measures the memory and the CPU time of reconstructing windows of frames.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "animation/spooled_frames.h"
#include "base/clock.h"
#include "memory/allocations.h"
#include "reconstruct/feature_film.h"
#include "reconstruct/space_time/joint_regression.h"
#include "reconstruct/space_time/sequence_pictures.h"
#include "reconstruct/space_time/window.h"
#include "reconstruct/space_time/window_solver.h"
#include "support/statistics.h"

namespace gradus::memory::window_test {
namespace {

// A cancel check that never cancels.
constexpr auto kNever = [] { return false; };

// Number of frames to each side that contribute to a picture, and of all of them.
constexpr int kReach = 4, kFrames = 2 * kReach + 1;

// A flat picture with the noise of few samples: few bright pixels, and differences with heavy tails. The values are
// kept in memory, so that reading them takes no time; the operating system likewise caches the file of a window.
class NoisySource final : public reconstruct::HalvedWindowSource {
 public:
  NoisySource(const reconstruct::WindowSize& size, test::Motion motion)
      : size_(size), row_(size_t(size.width) * size_t(size.channels)) {
    test::Window window(size.width, size.height, 0, size.frames);
    test::set_correspondences(&window, motion);
    correspondence_ = std::move(window.correspondence);
    for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
      values_.emplace_back(row_ * size_t(size.height) * size_t(size.frames));
      fill(kind, uint32_t(kind) + 1);
    }
  }
  reconstruct::WindowSize size() const override { return size_; }
  void read_row(reconstruct::RowKind kind, int t, int y, float* out) const override {
    std::copy_n(&values_[size_t(kind)][at(t, y)], row_, out);
  }
  void read_half_differences(reconstruct::RowKind kind, int t, int y, float* out) const override {
    read_row(kind, (t + 1) % size_.frames, y, out);
  }
  void read_correspondence(int t, int y, int32_t* out) const override {
    std::copy_n(correspondence_[size_t(t)].begin() + ptrdiff_t(y) * size_.width, size_.width, out);
  }

 private:
  size_t at(int t, int y) const { return row_ * size_t(t * size_.height + y); }

  // Fills the rows of one kind with random numbers.
  void fill(reconstruct::RowKind kind, uint32_t state) {
    for (float& value : values_[size_t(kind)]) {
      const float u = uniform(&state), v = uniform(&state);
      value = kind == reconstruct::RowKind::kPrimal ? 0.2f + 8.0f * std::pow(u, 8.0f)
                                                    : 0.1f * (u - 0.5f) * (v < 0.02f ? 40.0f : 1.0f);
    }
  }
  // Returns a random number in [0, 1] from the PCG generator.
  static float uniform(uint32_t* state) {
    *state = *state * 747796405u + 2891336453u;
    const uint32_t word = ((*state >> ((*state >> 28) + 4)) ^ *state) * 277803737u;
    return float((word >> 22) ^ word) * 0x1p-32f;
  }

  reconstruct::WindowSize size_;
  size_t row_;
  std::vector<std::vector<float>> values_;
  std::vector<std::vector<int32_t>> correspondence_;
};

constexpr reconstruct::WindowSize small_window() { return {320, 180, 3, 10}; }
constexpr reconstruct::WindowSize full_window() { return {1280, 720, 3, 10}; }

// Maximum bytes per pixel and frame of the solver. A small window has a larger maximum, because its borders are wider
// in relation to its size.
double max_bytes() { return test::full_run() ? 95.0 : 102.0; }

// Maximum number of steps of all systems together. With random correspondences the weights of neighbours, in space and
// time, differ by up to four orders of magnitude, which takes more steps.
int max_steps(test::Motion motion, uint32_t reconstruction) {
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) return 7;
  const bool smooth = motion == test::Motion::kStatic || motion == test::Motion::kPan;
  return smooth ? 19 : motion == test::Motion::kTurn ? 30 : 55;
}
// Maximum CPU seconds of the full window if all pixels move alike. The small window is too short to be timed.
double max_seconds(test::Motion motion) {
  return test::full_run() && (motion == test::Motion::kStatic || motion == test::Motion::kPan) ? 15.0 : 1e3;
}

TEST(J1_Window, UsesFourFieldsAndTheirGrids) {
  const reconstruct::WindowSize size = test::full_run() ? full_window() : small_window();
  const double pixels = double(size.width) * size.height * size.frames;
  for (const test::Motion motion :
       {test::Motion::kStatic, test::Motion::kPan, test::Motion::kTurn, test::Motion::kRandom}) {
    const NoisySource source(size, motion);
    for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1}) {
      const int64_t before = live_bytes();
      forget_peak();
      const uint64_t start = process_cpu_nanoseconds();
      reconstruct::SolveReport report;
      const reconstruct::WindowSolver solver(source, reconstruction, 0.0f, kNever, &report);
      const double seconds = 1e-9 * double(process_cpu_nanoseconds() - start),
                   bytes = double(peak_bytes() - before) / pixels;
      std::printf("  motion %d, reconstruction %u: %.1f bytes, %.2f CPU-s, %d steps, residual %.1e\n", int(motion),
                  reconstruction, bytes, seconds, report.inner_steps, double(report.residual));
      EXPECT_LE(bytes, max_bytes());
      EXPECT_LE(report.inner_steps, max_steps(motion, reconstruction));
      EXPECT_LE(seconds, max_seconds(motion));
      EXPECT_FALSE(report.hit_cap);
    }
  }
}

// The bytes are those of all frames that contribute to a picture, per pixel and frame. They include the film of the one
// frame that is open at a time. Every frame is opened once for all pictures, and once for its own sampled differences.
TEST(J1_Window, RegressionOverTimeUsesOneFilmAndAFewFieldsOfEachFrame) {
  const reconstruct::WindowSize size = test::full_run() ? full_window() : small_window();
  test::FeatureFilm description = test::room(size.width, size.height);
  description.gradients = true;
  test::Window window(size.width, size.height, 0, size.frames);
  test::set_correspondences(&window, test::Motion::kPan);
  const int64_t before = live_bytes();
  forget_peak();
  const uint64_t start = process_cpu_nanoseconds();
  uint64_t opening = 0;
  int opened = 0;
  reconstruct::SolveReport report;
  reconstruct::JointRegression joint(
      [&](int, const CancelCheck&) {
        const uint64_t begin = process_cpu_nanoseconds();
        auto film = std::make_shared<film::Film>(test::make_feature_film(description));
        opening += process_cpu_nanoseconds() - begin;
        ++opened;
        return film;
      },
      [&](int frame, const CancelCheck&) {
        return reconstruct::FrameStep{frame,
                                      {window.correspondence[size_t(frame + size.frames - 1) % size_t(size.frames)]}};
      });
  for (int frame = 0; frame < size.frames; ++frame) {
    const reconstruct::FrameRange around{std::max(frame - kReach, 0), std::min(frame + kReach, size.frames - 1)};
    EXPECT_FALSE(joint.reconstruct(frame, around, kNever, &report).image.empty());
  }
  const double pixels = double(size.width) * size.height, bytes = double(peak_bytes() - before) / (pixels * kFrames);
  std::printf("  %.1f bytes per pixel and contributing frame, %.2f µs per pixel and frame\n", bytes,
              1e-3 * double(process_cpu_nanoseconds() - start - opening) / (pixels * size.frames));
  EXPECT_LE(bytes, 200.0);
  EXPECT_EQ(opened, 2 * size.frames);
}

// Returns a film without light in which each pixel has one sample in each half-buffer.
std::shared_ptr<film::Film> flat_film(const reconstruct::WindowSize& size, int32_t number) {
  auto frame = std::make_shared<film::Film>(uint32_t(size.width), uint32_t(size.height),
                                            Region{0, 0, size.width, size.height}, 3, 1, true);
  for (auto& counts : frame->count) std::fill(counts.begin(), counts.end(), 1u);
  frame->frame_number = number;
  return frame;
}

// While frames are read, at most two of them are in memory; afterwards none is.
TEST(J1_Window, InputsAreReleased) {
  const reconstruct::WindowSize size = test::full_run() ? full_window() : small_window();
  const double pixels = double(size.width) * size.height * size.frames;
  const auto open = [&](int place, const CancelCheck&) { return flat_film(size, place); };
  const int64_t before = live_bytes();
  forget_peak();
  const uint64_t start = process_cpu_nanoseconds();
  animation::SpooledFrames frames(open, open, {});
  const auto window = frames.window(0, size.frames - 1);
  const double seconds = 1e-9 * double(process_cpu_nanoseconds() - start);
  const double held = double(live_bytes() - before) / pixels, maximum = double(peak_bytes() - before) / pixels;
  std::printf("  %.3f bytes, at most %.1f while they are read, %.2f CPU-s\n", held, maximum, seconds);
  EXPECT_LE(held, 0.1);
  EXPECT_LE(maximum, 80.0);
}

// The peak of memory does not grow with the length of a sequence.
TEST(J1_Window, SequencesOfAnyLengthNeedTheMemoryOfOneWindow) {
  const auto peak_of = [](int frames) {
    const int64_t before = live_bytes();
    forget_peak();
    reconstruct::SolveReport report;
    int delivered = 0;
    {
      reconstruct::SequencePictures pictures({0, frames - 1}, {},
                                             {[](const reconstruct::FrameRange& range, const CancelCheck&) {
                                                return std::make_unique<NoisySource>(
                                                    reconstruct::WindowSize{96, 64, 3, range.count()},
                                                    test::Motion::kStatic);
                                              },
                                              {},
                                              {}},
                                             {GRADUS_RECONSTRUCTION_L2, 0.0f, false});
      for (; delivered < frames; ++delivered) pictures.take(delivered, kNever, &report);
    }
    EXPECT_EQ(live_bytes(), before);
    return peak_bytes() - before;
  };
  const int64_t few = peak_of(15);
  EXPECT_LE(peak_of(60), few + few / 100);
}

}  // namespace
}  // namespace gradus::memory::window_test
