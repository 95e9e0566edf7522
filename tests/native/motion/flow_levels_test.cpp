// Frames of a component as grey images.
#include "motion/flow_levels.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace gradus::flow_levels_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<Rgb> greys(const std::vector<float>& values) {
  std::vector<Rgb> result;
  for (const float value : values) result.emplace_back(value);
  return result;
}

TEST(FlowLevels, BothFramesAreOnOneScaleThatTheyFill) {
  const auto levels = motion::flow_levels(2, 1, greys({1.0f, 2.0f}), greys({3.0f, 5.0f}), motion::FlowDomain::Linear);
  EXPECT_EQ(levels[0].levels[0], 0.0f);
  EXPECT_NEAR(levels[0].levels[1], 0.25f * 255.0f, 1e-3f);
  EXPECT_NEAR(levels[1].levels[0], 0.5f * 255.0f, 1e-3f);
}

TEST(FlowLevels, EqualRatiosAreEqualDistancesInTheLogarithmicDomain) {
  const auto levels = motion::flow_levels(4, 1, greys({1.0f, 2.0f, 4.0f, 8.0f}), greys({1.0f, 2.0f, 4.0f, 8.0f}),
                                          motion::FlowDomain::Logarithmic)[0]
                          .levels;
  EXPECT_NEAR(levels[2] - levels[1], levels[1] - levels[0], 2.0f);
}

// Regression: a firefly left one level for all other values.
TEST(FlowLevels, AFireflyDoesNotSetTheScale) {
  std::vector<float> values(2000, 1.0f);
  for (size_t i = 0; i < values.size(); ++i) values[i] += float(i % 100) * 0.01f;
  std::vector<float> with = values;
  with[77] = 1e6f;
  const auto plain =
      motion::flow_levels(50, 40, greys(values), greys(values), motion::FlowDomain::Logarithmic)[0].levels;
  const auto bright = motion::flow_levels(50, 40, greys(values), greys(with), motion::FlowDomain::Logarithmic);
  EXPECT_GT(bright[0].levels[99], 0.0f);
  EXPECT_EQ(bright[1].levels[77], 255.0f);
  EXPECT_GT(plain[99] - plain[0], 100.0f);
}

TEST(FlowLevels, NoiseAloneIsNotStretchedToTheWholeScale) {
  std::vector<float> values;
  for (int i = 0; i < 400; ++i) values.push_back(i % 2 == 0 ? 1.0f : 1.01f);
  for (const motion::FlowDomain domain : {motion::FlowDomain::Linear, motion::FlowDomain::Logarithmic}) {
    const auto levels = motion::flow_levels(20, 20, greys(values), greys(values), domain)[0].levels;
    EXPECT_LT(levels[1] - levels[0], 15.0f);
    EXPECT_GT(levels[1] - levels[0], 1.0f);
  }
}

TEST(FlowLevels, AnyNumbersGiveLevels) {
  const float odd[] = {kNaN, kInfinity, -kInfinity, 3e38f, -3e38f, 0.0f, -1.0f, 1e-42f};
  for (const motion::FlowDomain domain : {motion::FlowDomain::Linear, motion::FlowDomain::Logarithmic}) {
    for (const motion::GreyImage& image :
         motion::flow_levels(4, 2, greys({odd, odd + 8}), greys(std::vector<float>(8, kNaN)), domain)) {
      ASSERT_EQ(image.levels.size(), 8u);
      for (const float level : image.levels) EXPECT_TRUE(level >= 0.0f && level <= 255.0f) << level;
    }
    EXPECT_TRUE(motion::flow_levels(0, 0, {}, {}, domain)[1].levels.empty());
  }
}

}  // namespace
}  // namespace gradus::flow_levels_test
