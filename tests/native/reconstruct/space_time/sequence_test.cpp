// Sequences of any length, window by window.
#include <gtest/gtest.h>

#include "reconstruct/space_time/reconstruct_sequence.h"
#include "reconstruct/space_time/sequences.h"

namespace gradus {
namespace {

using namespace test;

TEST(B2_Windows, SharesOfAFrameAddUpToOne) {
  for (const FrameRange range : {FrameRange{0, 9}, {3, 4}, {1, 1}, {-13, 27}, {4, 5}, {0, 100}, {3, 12}, {-5, -1}}) {
    const WindowGrid grid(range);
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

// A range that is rendered in parts has the windows of the whole, where their frames are there.
TEST(B2_Windows, LieOnAFixedGrid) {
  EXPECT_EQ(WindowGrid({0, 30}).frames(2).first, 10);
  EXPECT_EQ(WindowGrid({7, 30}).frames(2).last, 19);
  EXPECT_EQ(WindowGrid({7, 30}).frames(1).first, 7);
  EXPECT_EQ(WindowGrid({-7, 30}).frames(-1).first, -5);
  EXPECT_EQ(WindowGrid({7, 30}).share(2, 12), WindowGrid({-7, 99}).share(2, 12));
}

TEST(B2_Windows, NoWindowLiesWithinAnother) {
  for (int first = -6; first < 6; ++first) {
    for (int last = first; last < first + 25; ++last) {
      const WindowGrid grid({first, last});
      EXPECT_EQ(grid.frames(grid.first()).first, first);
      EXPECT_EQ(grid.frames(grid.last()).last, last);
      for (int window = grid.first(); window < grid.last(); ++window) {
        EXPECT_LT(grid.frames(window).first, grid.frames(window + 1).first);
        EXPECT_LT(grid.frames(window).last, grid.frames(window + 1).last);
      }
    }
  }
}

// The frame t of a sequence without end: a ramp that drifts.
float value_of(int frame, int x, int y) { return 1.0f + 0.01f * float(frame) + 0.1f * std::sin(0.3f * float(x + y)); }

std::unique_ptr<Window> open_static(const FrameRange& frames) {
  auto window = std::make_unique<Window>(16, 12, 1, frames.count());
  link(window.get(), Motion::kStatic);
  Images images;
  for (int t = frames.first; t <= frames.last; ++t) {
    images.push_back(make_image(16, 12, 1, [t](int x, int y, int) { return value_of(t, x, y); }));
  }
  window->measure(images);
  for (int t = 0; t < frames.count(); ++t) add_noise(&window->plane(RowKind::kPrimal, t), 0.5f, unsigned(frames.first + t));
  return window;
}

TEST(B2_Windows, EveryFrameIsDeliveredOnceAndInOrder) {
  for (const FrameRange range : {FrameRange{0, 9}, {2, 2}, {-3, 31}}) {
    int next = range.first;
    SolveReport report;
    reconstruct_sequence(
        range, [](const FrameRange& frames) { return open_static(frames); }, GRADUS_RECONSTRUCTION_L2, 0.0f, never, &report,
        [&](int frame, std::vector<float> image) {
          EXPECT_EQ(frame, next++);
          ASSERT_EQ(image.size(), 16u * 12u);
          for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 16; ++x) EXPECT_NEAR(image[size_t(16 * y + x)], value_of(frame, x, y), 0.25f);
          }
        });
    EXPECT_EQ(next, range.last + 1);
  }
}

// A frame in the middle of its window and of the next: half of each.
TEST(B2_Windows, OverlapsAreBlended) {
  SolveReport report;
  const auto solve = [&](const FrameRange& frames) {
    return joined(WindowSolver(*open_static(frames), GRADUS_RECONSTRUCTION_L2, 0.0f, never, &report).solution());
  };
  const std::vector<float> before = solve({0, 9}), after = solve({5, 14});
  const WindowGrid grid({0, 14});
  reconstruct_sequence(
      {0, 14}, [](const FrameRange& frames) { return open_static(frames); }, GRADUS_RECONSTRUCTION_L2, 0.0f, never, &report,
      [&](int frame, const std::vector<float>& image) {
        const float share = grid.share(0, frame);
        EXPECT_EQ(share, frame < 5 ? 1.0f : frame > 9 ? 0.0f : share);
        for (size_t i = 0; i < image.size(); ++i) {
          const float a = frame <= 9 ? before[size_t(frame) * image.size() + i] : 0.0f;
          const float b = frame >= 5 ? after[size_t(frame - 5) * image.size() + i] : 0.0f;
          EXPECT_NEAR(image[i], share * a + (1.0f - share) * b, 1e-5f);
        }
      });
  EXPECT_NEAR(grid.share(0, 7), 0.5f, 1e-6f);
  EXPECT_NEAR(grid.share(1, 7), 0.5f, 1e-6f);
}

TEST(K2_Cancel, SequencesDeliverNothingHalfDone) {
  int frames = 0;
  SolveReport report;
  reconstruct_sequence(
      {0, 14}, [](const FrameRange& range) { return open_static(range); }, GRADUS_RECONSTRUCTION_L2, 0.0f, [] { return true; }, &report,
      [&](int, const std::vector<float>&) { ++frames; });
  EXPECT_EQ(frames, 0);
}

}  // namespace
}  // namespace gradus
