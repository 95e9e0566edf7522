// Pixels that show an edge.
#include "motion/flow_frame.h"

#include <limits>
#include <numeric>

#include <gtest/gtest.h>

namespace gradus::silhouettes_test {
namespace {

constexpr int kSize = 20;

template <class Value>
auto plane(const Value& value) {
  std::vector<decltype(value(0, 0))> result;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) result.push_back(value(x, y));
  }
  return result;
}
int count(const std::vector<uint8_t>& edges) { return std::accumulate(edges.begin(), edges.end(), 0); }

TEST(Silhouettes, AreBothSidesOfAnObjectsEdge) {
  const auto object = plane([](int x, int) { return int32_t(x < 8 ? 1 : 2); });
  const auto edges = motion::silhouettes(kSize, kSize, object, {});
  for (int x = 0; x < kSize; ++x) EXPECT_EQ(edges[size_t(5 * kSize + x)], x == 7 || x == 8) << x;
}

TEST(Silhouettes, AreStepsOfDepth) {
  const auto depth = plane([](int x, int) { return x < 8 ? 3.0f : 4.0f; });
  const auto edges = motion::silhouettes(kSize, kSize, {}, depth);
  for (int x = 0; x < kSize; ++x) EXPECT_EQ(edges[size_t(5 * kSize + x)], x == 7 || x == 8) << x;
}

TEST(Silhouettes, AreEdgesBeforeTheBackground) {
  const auto depth = plane([](int x, int) { return x < 8 ? 3.0f : 0.0f; });
  EXPECT_EQ(count(motion::silhouettes(kSize, kSize, {}, depth)), 2 * kSize);
}

// Regression: 1/depth is linear over a plane, but depth is not; a plane at a grazing angle was all edges.
TEST(Silhouettes, APlaneSeenAtAGrazingAngleHasNone) {
  const auto depth = plane([](int, int y) { return 1.0f / (0.001f + 0.05f * float(kSize - y)); });
  EXPECT_EQ(count(motion::silhouettes(kSize, kSize, {}, depth)), 0);
}

TEST(Silhouettes, AnEmptyFilmHasNone) {
  EXPECT_EQ(count(motion::silhouettes(kSize, kSize, {}, {})), 0);
  EXPECT_TRUE(motion::silhouettes(0, 0, {}, {}).empty());
  const std::vector<float> odd = {std::numeric_limits<float>::quiet_NaN()};
  EXPECT_EQ(motion::silhouettes(1, 1, {}, odd), std::vector<uint8_t>{0});
}

}  // namespace
}  // namespace gradus::silhouettes_test
