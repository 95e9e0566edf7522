// The samples of another frame in the pixels of a picture.
#include "reconstruct/space_time/moved_samples.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"
#include "reconstruct/space_time/light_test.h"

namespace gradus::moved_samples_test {
namespace {

constexpr int kWidth = 21, kHeight = 15;  // cells at the borders are cut

// Returns a frame whose light is the same in all pixels.
reconstruct::FrameRecords frame(float light, float variance, float scale) {
  reconstruct::FrameRecords frame;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.scale = scale;
  frame.pixels.resize(size_t(kWidth) * kHeight);
  for (reconstruct::SampleRecord& record : frame.pixels) {
    for (int c = 0; c < 3; ++c) record.values[reconstruct::kRecordMean + c] = light;
    record.values[reconstruct::kRecordVariance] = variance;
    record.values[reconstruct::kRecordDepth] = 2.0f;
    record.values[reconstruct::kRecordWeight] = record.values[reconstruct::kRecordOwnWeight] = 1.0f;
  }
  return frame;
}

reconstruct::MovedSamples moved(const reconstruct::FrameRecords& from, const reconstruct::FrameRecords& to) {
  const reconstruct::Field regressed =
      reconstruct::make_field(kWidth, kHeight, [&](int, int) { return to.at(0)[reconstruct::kRecordMean] / to.scale; });
  return reconstruct::move_samples(
      from, reconstruct::own_pixels(kWidth, kHeight),
      reconstruct::compared_picture(
          to, reconstruct::join_channels(reconstruct::join_channels(regressed, regressed), regressed)));
}

// Light without noise, such as that of a source seen directly, has no rounding errors, whatever the medians of the
// frames are.
TEST(B2_MovedSamples, LightWithoutNoiseIsTheSameInFramesOfAnyMedian) {
  for (const float scale : {0.37f, 1.0f, 1.7f, 1e9f}) {
    const reconstruct::MovedSamples samples = moved(frame(0.7f, 0.0f, scale), frame(0.7f, 0.0f, 1.3f));
    EXPECT_FALSE(any_value(samples.kept, [](float share) { return share != 1.0f; })) << scale;
  }
  const reconstruct::MovedSamples other = moved(frame(0.70001f, 0.0f, 1.3f), frame(0.7f, 0.0f, 1.3f));
  EXPECT_FALSE(any_value(other.kept, [](float share) { return share != 0.0f; }));
}

// Variances are in units of each frame.
TEST(C5_MovedSamples, DifferencesAreComparedWithTheNoiseOfBothFrames) {
  constexpr float kNoise = 0.1f;
  for (const float difference : {0.0f, 1.0f}) {
    for (const float scale : {0.5f, 1.0f, 4.0f}) {
      const reconstruct::MovedSamples samples =
          moved(frame(1.0f + difference, kNoise / (scale * scale), scale), frame(1.0f, kNoise / 4.0f, 2.0f));
      EXPECT_FALSE(any_value(samples.kept, [&](float share) { return share != (difference == 0.0f ? 1.0f : 0.0f); }))
          << difference << ", " << scale;
    }
  }
}

// An object without light that fades shows its change in alpha alone. Noise of alpha is not a change.
TEST(C5_MovedSamples, AlphaIsCompared) {
  const auto with_alpha = [](float alpha, float variance) {
    reconstruct::FrameRecords records = frame(0.0f, 0.0f, 1.0f);
    records.alpha.assign(size_t(kWidth) * kHeight, {alpha, variance});
    return records;
  };
  const auto keeps = [&](float here, float there, float variance) {
    const reconstruct::MovedSamples samples = moved(with_alpha(there, variance), with_alpha(here, variance));
    const float share = samples.kept.row(0)[0];
    EXPECT_FALSE(any_value(samples.kept, [share](float other) { return other != share; }));
    return share;
  };
  EXPECT_EQ(keeps(1.0f, 1.0f, 0.0f), 1.0f);
  EXPECT_EQ(keeps(1.0f, 0.9999f, 0.0f), 1.0f);
  EXPECT_EQ(keeps(1.0f, 0.95f, 0.0f), 0.0f);
  EXPECT_EQ(keeps(0.5f, 0.52f, 0.25f), 1.0f);
  EXPECT_EQ(keeps(0.9f, 0.1f, 0.05f), 0.0f);
}

// Where samples lie beside the centres of their pixels, alpha that changes from pixel to pixel is predicted, at edges
// within some variance.
TEST(B2_MovedSamples, AlphaOfDisplacedSamplesIsTheSame) {
  constexpr float kMoved = 0.4f;
  const auto slope = [](float x) { return 0.2f + 0.03f * x; };
  const auto edge = [](float x) { return std::clamp(x - 9.7f, 0.0f, 1.0f); };
  for (const std::function<float(float)>& alpha : {std::function<float(float)>(slope), {edge}}) {
    const auto records = [&](float moved) {
      reconstruct::FrameRecords records = frame(0.0f, 0.0f, 1.0f);
      for (int i = 0; i < kWidth * kHeight; ++i) records.alpha.push_back({alpha(float(i % kWidth) + moved), 0.0f});
      return records;
    };
    reconstruct::PixelTrack track = reconstruct::own_pixels(kWidth, kHeight);
    for (Vec2& displacement : track.displacement) displacement.x = kMoved;
    const reconstruct::FrameRecords here = records(0.0f);
    const reconstruct::MovedSamples samples = reconstruct::move_samples(
        records(kMoved), track, reconstruct::compared_picture(here, reconstruct::Field(kWidth, kHeight, 3)));
    const float* kept = samples.kept.row(samples.kept.height() / 2);
    // The border pixels repeat, so that the slope ends there.
    EXPECT_TRUE(std::all_of(kept + 4, kept + samples.kept.width() - 4, [](float share) { return share == 1.0f; }));
  }
}

// Regression: light beyond the range of floats made the shares of all pixels around it not a number.
TEST(BadInput_MovedSamples, LightWithoutBoundIsDropped) {
  reconstruct::FrameRecords bright = frame(1.0f, 0.1f, 1e-3f);
  const int lit = 7 * kWidth + 10;
  bright.pixels[size_t(lit)].values[reconstruct::kRecordMean] = 1e37f;
  const reconstruct::MovedSamples samples = moved(bright, frame(1.0f, 0.1f, 1e-3f));
  EXPECT_FALSE(any_value(samples.kept, [](float share) { return !(share >= 0.0f && share <= 1.0f); }));
  EXPECT_EQ(samples.kept.row(3)[5], 0.0f);
}

// Depths are those that the picture sees; where none is known they stay.
TEST(B2_MovedSamples, DepthsAreThoseOfThePicture) {
  reconstruct::FrameRecords there = frame(1.0f, 0.1f, 1.0f), here = there;
  for (reconstruct::SampleRecord& record : here.pixels) record.values[reconstruct::kRecordDepth] = 3.0f;
  EXPECT_FALSE(any_value(moved(there, here).depth_ratio, [](float ratio) { return std::fabs(ratio - 1.5f) > 1e-6f; }));
  for (reconstruct::SampleRecord& record : there.pixels) record.values[reconstruct::kRecordDepth] = 0.0f;
  EXPECT_FALSE(any_value(moved(there, here).depth_ratio, [](float ratio) { return ratio != 1.0f; }));
}

}  // namespace
}  // namespace gradus::moved_samples_test
