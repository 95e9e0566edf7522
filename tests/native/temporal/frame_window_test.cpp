// Rows of a window made of two sampled frames and their links.
#include "temporal/frame_window.h"

#include <cmath>

#include <gtest/gtest.h>

namespace gradus {
namespace {

// A row of three pixels, the same in all channels: values, differences to the right, and half the differences of halves of both.
GradientImages row_of(const std::vector<float>& primal, const std::vector<float>& dx) {
  GradientImages images;
  images.width = 3;
  images.height = 1;
  for (const float v : primal) images.primal.insert(images.primal.end(), 3, v);
  for (const float v : dx) images.dx.insert(images.dx.end(), 3, v);
  images.dy.assign(9, 0.0f);
  return images;
}

class TwoFrames : public testing::Test {
 protected:
  TwoFrames() {
    auto first = std::make_shared<TemporalFrame>(), second = std::make_shared<TemporalFrame>();
    first->base = {row_of({1, 2, 3}, {10, 20, 0}), row_of({0.1f, 0.2f, 0.3f}, {1, 2, 0})};
    first->replay = first->base;  // of the first frame: a stream of its own
    first->replay_share = {0.5f, 0.5f, 0.5f};
    first->links = {1, 2, kNoLink};  // the picture moves to the right by a pixel
    second->base = {row_of({4, 5, 6}, {40, kAbsentPair, 0}), row_of({0.4f, 0.5f, 0.6f}, {4, 5, 0})};
    second->replay = {row_of({7, 8, 9}, {70, 80, 0}), row_of({0.7f, 0.8f, 0.9f}, {7, 8, 0})};
    second->replay_share = {0.5f, 0.5f, 0.25f};
    frames_ = {first, second};
  }
  std::vector<float> row(RowKind kind, int t) const {
    std::vector<float> out(9);
    FrameWindow(frames_).read_row(kind, t, 0, out.data());
    return {out[0], out[3], out[6]};
  }
  std::vector<float> half_differences(RowKind kind, int t) const {
    std::vector<float> out(9);
    FrameWindow(frames_).read_half_differences(kind, t, 0, out.data());
    return {out[0], out[3], out[6]};
  }
  std::vector<float> deviations(RowKind kind, int t) const {
    std::vector<float> out(3);
    FrameWindow(frames_).read_deviations(kind, t, 0, out.data());
    return out;
  }
  std::vector<std::shared_ptr<const TemporalFrame>> frames_;
};

TEST_F(TwoFrames, RowsInSpaceAreMeansOverAllSamples) {
  EXPECT_EQ(row(RowKind::kPrimal, 0), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(row(RowKind::kPrimal, 1), (std::vector<float>{5.5f, 6.5f, 6.75f}));
  EXPECT_EQ(row(RowKind::kDx, 1)[0], 55.0f);
  EXPECT_EQ(row(RowKind::kDx, 1)[1], 80.0f) << "what one of the two lacks is the other's";
}

TEST_F(TwoFrames, RowsInTimeAreDifferencesAlongTheLinks) {
  const std::vector<float> dt = row(RowKind::kDt, 0), dxdt = row(RowKind::kDxDt, 0);
  EXPECT_EQ(dt[0], 8.0f - 1.0f);
  EXPECT_EQ(dt[1], 9.0f - 2.0f);
  EXPECT_TRUE(std::isnan(dt[2])) << "without a link there is nothing to compare";
  EXPECT_EQ(dxdt[0], 80.0f - 10.0f);
}

// Base and replay take the same random numbers: their halves differ alike, and the difference over time is more certain than either.
TEST_F(TwoFrames, DeviationsAreThoseOfTheRows) {
  EXPECT_NEAR(deviations(RowKind::kPrimal, 1)[0], 0.55f, 1e-6f);
  EXPECT_NEAR(deviations(RowKind::kDt, 0)[0], 0.7f, 1e-6f);
  EXPECT_NEAR(deviations(RowKind::kDxDt, 0)[0], 7.0f, 1e-5f);
}

TEST_F(TwoFrames, HalfDifferencesAreThoseOfTheRows) {
  EXPECT_NEAR(half_differences(RowKind::kDt, 0)[1], 0.9f - 0.2f, 1e-6f);
  EXPECT_TRUE(std::isnan(half_differences(RowKind::kDt, 0)[2]));
}

}  // namespace
}  // namespace gradus
