// Sequences of any length, window by window.
#include <limits>

#include <gtest/gtest.h>

#include "base/error.h"
#include "reconstruct/error_estimate.h"
#include "reconstruct/space_time/sequence_pictures.h"
#include "reconstruct/space_time/sequences.h"
#include "reconstruct/space_time/window_solver.h"

namespace gradus::sequence_test {
namespace {

using namespace test;

TEST(B2_Windows, SharesOfAFrameAddUpToOne) {
  for (const reconstruct::FrameRange range :
       {reconstruct::FrameRange{0, 9}, {3, 4}, {1, 1}, {-13, 27}, {4, 5}, {0, 100}, {3, 12}, {-5, -1}}) {
    const reconstruct::WindowGrid grid(range);
    for (int frame = range.first; frame <= range.last; ++frame) {
      float sum = 0.0f;
      int windows = 0;
      for (int window = grid.first(); window <= grid.last(); ++window) {
        const float share = grid.share(window, frame);
        EXPECT_EQ(share > 0.0f, grid.frames(window).contains(frame));
        sum += share;
        windows += share > 0.0f;
      }
      EXPECT_NEAR(sum, 1.0f, 1e-6f) << frame << " of " << range.first << " to " << range.last;
      EXPECT_LE(windows, 2);
    }
  }
}

// A range that is rendered in parts has the windows of the whole, where the frames exist.
TEST(B2_Windows, LieOnAFixedGrid) {
  EXPECT_EQ(reconstruct::WindowGrid({0, 30}).frames(2).first, 10);
  EXPECT_EQ(reconstruct::WindowGrid({7, 30}).frames(2).last, 19);
  EXPECT_EQ(reconstruct::WindowGrid({7, 30}).frames(1).first, 7);
  EXPECT_EQ(reconstruct::WindowGrid({-7, 30}).frames(-1).first, -5);
  EXPECT_EQ(reconstruct::WindowGrid({7, 30}).share(2, 12), reconstruct::WindowGrid({-7, 99}).share(2, 12));
}

TEST(B2_Windows, NoWindowLiesWithinAnother) {
  for (int first = -6; first < 6; ++first) {
    for (int last = first; last < first + 25; ++last) {
      const reconstruct::WindowGrid grid({first, last});
      EXPECT_EQ(grid.frames(grid.first()).first, first);
      EXPECT_EQ(grid.frames(grid.last()).last, last);
      for (int window = grid.first(); window < grid.last(); ++window) {
        EXPECT_LT(grid.frames(window).first, grid.frames(window + 1).first);
        EXPECT_LT(grid.frames(window).last, grid.frames(window + 1).last);
      }
    }
  }
}

// Returns a pixel of frame t of an endless sequence: a ramp that drifts.
float value_of(int frame, int x, int y) { return 1.0f + 0.01f * float(frame) + 0.1f * std::sin(0.3f * float(x + y)); }

std::unique_ptr<Window> open_static(const reconstruct::FrameRange& frames) {
  auto window = std::make_unique<Window>(16, 12, 1, frames.count());
  set_correspondences(window.get(), Motion::kStatic);
  Images images;
  for (int t = frames.first; t <= frames.last; ++t) {
    images.push_back(make_image(16, 12, 1, [t](int x, int y, int) { return value_of(t, x, y); }));
  }
  window->measure(images);
  for (int t = 0; t < frames.count(); ++t)
    add_noise(&window->plane(reconstruct::RowKind::kPrimal, t), 0.5f, unsigned(frames.first + t));
  return window;
}

reconstruct::SequencePictures static_sequence(const reconstruct::FrameRange& range, bool with_error = false) {
  return reconstruct::SequencePictures(
      range, {},
      {[](const reconstruct::FrameRange& frames, const CancelCheck&) { return open_static(frames); }, {}, {}},
      {GRADUS_RECONSTRUCTION_L2, 0.0f, with_error});
}

TEST(B2_Windows, EveryFrameIsDeliveredOnceAndInOrder) {
  for (const reconstruct::FrameRange range : {reconstruct::FrameRange{0, 9}, {2, 2}, {-3, 31}}) {
    reconstruct::SequencePictures pictures = static_sequence(range);
    reconstruct::SolveReport report;
    for (int frame = range.first; frame <= range.last; ++frame) {
      const std::vector<float> image = pictures.take(frame, never, &report).image;
      ASSERT_EQ(image.size(), 16u * 12u);
      for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < 16; ++x) EXPECT_NEAR(image[size_t(16 * y + x)], value_of(frame, x, y), 0.25f);
      }
    }
    EXPECT_THROW(pictures.take(range.last, never, &report), Error);
  }
}

// A job that begins in the middle of a sequence, and one that ends early.
TEST(B2_Windows, PicturesDoNotDependOnWhereAJobBegins) {
  reconstruct::SolveReport report;
  reconstruct::SequencePictures whole = static_sequence({0, 24}), part = static_sequence({0, 24});
  for (int frame = 0; frame < 12; ++frame) whole.take(frame, never, &report);
  for (int frame = 12; frame < 25; ++frame)
    EXPECT_EQ(whole.take(frame, never, &report).image, part.take(frame, never, &report).image);
}

TEST(B2_Windows, ASequenceThatEndsEarlyIsCompleteUpToThere) {
  reconstruct::SolveReport report;
  reconstruct::SequencePictures pictures = static_sequence({0, 24});
  pictures.take(0, never, &report);
  pictures.end_at(11);
  for (int frame = 1; frame <= 11; ++frame) {
    const std::vector<float> image = pictures.take(frame, never, &report).image;
    for (int x = 0; x < 16; ++x) EXPECT_NEAR(image[size_t(x)], value_of(frame, x, 0), 0.25f) << frame;
  }
}

TEST(B2_Windows, HaveTheGridOfTheirSettings) {
  for (const reconstruct::WindowShape shape : {reconstruct::WindowShape{6, 3}, {8, 2}, {4, 0}, {1, 0}}) {
    const reconstruct::WindowGrid grid({-7, 30}, shape);
    for (int frame = -7; frame <= 30; ++frame) {
      float sum = 0.0f;
      for (int window = grid.first(); window <= grid.last(); ++window) {
        sum += grid.share(window, frame);
        EXPECT_EQ(grid.frames(window).contains(frame),
                  window >= grid.first_with(frame) && window <= grid.last_with(frame));
      }
      EXPECT_NEAR(sum, 1.0f, 1e-6f) << frame;
    }
  }
  EXPECT_THROW(reconstruct::WindowGrid({0, 9}, {4, 3}), Error);
}

// Regression: twice the overlap exceeded the range of integers, and so did the end of the last window.
TEST(B2_Windows, OfAnySizeAreRefusedOrCorrect) {
  constexpr int maximum = std::numeric_limits<int>::max();
  EXPECT_THROW(reconstruct::WindowGrid({0, 9}, {10, 1 << 30}), Error);
  EXPECT_THROW(reconstruct::WindowGrid({0, 9}, {maximum, 1 << 30}), Error);
  const reconstruct::WindowGrid wide({-5, 9}, {maximum, maximum / 2});
  EXPECT_EQ(wide.frames(wide.last()).last, 9);
  const reconstruct::WindowGrid late({maximum - 7, maximum});
  EXPECT_EQ(late.frames(late.last()).last, maximum);
}

// A frame in the middle of the overlap of two windows: half of each.
TEST(B2_Windows, OverlapsAreBlended) {
  reconstruct::SolveReport report;
  const auto solve = [&](const reconstruct::FrameRange& frames) {
    return joined(
        reconstruct::WindowSolver(*open_static(frames), GRADUS_RECONSTRUCTION_L2, 0.0f, never, &report).solution());
  };
  const std::vector<float> before = solve({0, 9}), after = solve({5, 14});
  const reconstruct::WindowGrid grid({0, 14});
  reconstruct::SequencePictures pictures = static_sequence({0, 14});
  for (int frame = 0; frame <= 14; ++frame) {
    const std::vector<float> image = pictures.take(frame, never, &report).image;
    const float share = grid.share(0, frame);
    EXPECT_EQ(share, frame < 5 ? 1.0f : frame > 9 ? 0.0f : share);
    for (size_t i = 0; i < image.size(); ++i) {
      const float a = frame <= 9 ? before[size_t(frame) * image.size() + i] : 0.0f;
      const float b = frame >= 5 ? after[size_t(frame - 5) * image.size() + i] : 0.0f;
      EXPECT_NEAR(image[i], share * a + (1.0f - share) * b, 1e-5f);
    }
  }
  EXPECT_NEAR(grid.share(0, 7), 0.5f, 1e-6f);
  EXPECT_NEAR(grid.share(1, 7), 0.5f, 1e-6f);
}

TEST(K2_Cancel, SequencesDeliverNothingIncomplete) {
  reconstruct::SolveReport report;
  EXPECT_TRUE(static_sequence({0, 14})
                  .take(
                      0, [] { return true; }, &report)
                  .image.empty());
}

// The reported error is that of the pictures, on average over noise.
TEST(B2_Windows, ReportTheErrorOfTheirPictures) {
  double told = 0.0, found = 0.0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    const auto noisy = [&](const reconstruct::FrameRange& frames, const CancelCheck&) {
      auto window = std::make_unique<Window>(16, 12, 3, frames.count());
      set_correspondences(window.get(), Motion::kStatic);
      for (int t = 0; t < frames.count(); ++t) {
        add_noise(&window->plane(reconstruct::RowKind::kPrimal, t), 0.2f, 9000 + 20 * seed + unsigned(t));
        add_noise(&window->halves[size_t(reconstruct::RowKind::kPrimal)][size_t(t)], 0.2f,
                  7000 + 20 * seed + unsigned(t));
      }
      return window;
    };
    reconstruct::SequencePictures pictures({0, 5}, {}, {noisy, {}, {}}, {GRADUS_RECONSTRUCTION_L2, 0.0f, true});
    reconstruct::SolveReport report;
    for (int frame = 0; frame <= 5; ++frame) {
      const reconstruct::Reconstructed picture = pictures.take(frame, never, &report);
      for (const float error : reconstruct::error_of_pixels(picture.terms, 16, 12, 3)) told += error;
      for (const float value : picture.image) found += std::pow(value, 2.0) / 3.0;  // the true picture is black
    }
  }
  EXPECT_NEAR(told / found, 1.0, 0.15);
}

}  // namespace
}  // namespace gradus::sequence_test
