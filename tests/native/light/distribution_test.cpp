// Densities over the unit square.
#include "light/distribution.h"

#include <random>

#include <gtest/gtest.h>

namespace gradus::distribution_test {
namespace {

struct Size {
  uint32_t width, height;
};
constexpr Size kSizes[] = {{1, 1}, {16, 8}, {18, 9}, {64, 32}, {100, 50}, {1030, 515}};

// Returns values of which a tenth is 0 and few are a thousand times as large as others.
std::vector<float> make_values(const Size& size, std::mt19937* random) {
  std::uniform_real_distribution<float> uniform;
  std::vector<float> values(size_t(size.width) * size.height);
  for (float& value : values) value = uniform(*random) < 0.1f ? 0.0f : std::pow(uniform(*random), 8.0f) + 1e-3f;
  values.front() = 1.0f;
  return values;
}

Vec2 centre(const Size& size, uint32_t cell) {
  return (Vec2(float(cell % size.width), float(cell / size.width)) + 0.5f) /
         Vec2(float(size.width), float(size.height));
}

TEST(A3_Distribution, IntegratesToOneAndFollowsItsValues) {
  std::mt19937 random(1);
  for (const Size& size : kSizes) {
    const std::vector<float> values = make_values(size, &random);
    const light::Distribution2D distribution(size.width, size.height, values);
    double sum = 0.0, integral = 0.0, difference = 0.0;
    for (const float value : values) sum += value;
    for (uint32_t i = 0; i < values.size(); ++i) {
      const double density = distribution.density(centre(size, i)), exact = values[i] / sum * double(values.size());
      EXPECT_EQ(density > 0.0, values[i] > 0.0f);
      integral += density / double(values.size());
      difference += std::fabs(density - exact) / double(values.size());
    }
    EXPECT_NEAR(integral, 1.0, 1e-5);
    EXPECT_LT(difference, 1e-3) << size.width;
  }
}

// Each cell receives as many of a regular grid of points as its density says, up to the points at its borders.
TEST(A3_Distribution, SamplesByItsDensity) {
  std::mt19937 random(2);
  constexpr uint32_t kSide = 1024;
  for (const Size& size : kSizes) {
    if (size.width > 200) continue;
    const light::Distribution2D distribution(size.width, size.height, make_values(size, &random));
    std::vector<double> counts(size_t(size.width) * size.height);
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
      const Vec2 p = distribution.sample((Vec2(float(i % kSide), float(i / kSide)) + 0.5f) / float(kSide));
      ASSERT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f);
      ASSERT_GT(distribution.density(p), 0.0f);
      ++counts[uint32_t(p.y * float(size.height)) * size.width + uint32_t(p.x * float(size.width))];
    }
    double difference = 0.0;
    for (uint32_t i = 0; i < counts.size(); ++i)
      difference +=
          std::fabs(counts[i] / double(kSide * kSide) - distribution.density(centre(size, i)) / double(counts.size()));
    EXPECT_LT(difference, 0.05) << size.width;
  }
}

TEST(Distribution, EndsOfTheSquareAreCells) {
  std::vector<float> values(18 * 9, 0.0f);
  values.front() = values.back() = 1.0f;
  const light::Distribution2D distribution(18, 9, values);
  constexpr float kBelowOne = 0x1.fffffep-1f;
  EXPECT_GT(distribution.density(distribution.sample(Vec2(0.0f))), 0.0f);
  EXPECT_GT(distribution.density(distribution.sample(Vec2(kBelowOne))), 0.0f);
  EXPECT_GT(distribution.density(Vec2(1.0f)), 0.0f);
}

}  // namespace
}  // namespace gradus::distribution_test
