// Contract 1.3: splats of units of work merge in a fixed order and are normalised globally. A small light tracer stands
// in for a real one.
#include "film/splats.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <random>
#include <thread>

namespace gradus {
namespace {

constexpr Region kRegion{3, 2, 11, 7};
constexpr uint32_t kUnits = 64;
constexpr uint64_t kPathsPerUnit = 512;

float truth(int32_t x, int32_t y) { return 1.0f + 0.1f * float(x) + 0.3f * float(y); }

// Light paths that meet the film everywhere around the region; a second splat, as of a longer path, half as bright.
std::vector<film::Splat> trace(uint32_t unit) {
  constexpr int kSide = 16;
  std::mt19937 random(unit);
  std::uniform_int_distribution<int32_t> at(0, kSide - 1);
  std::vector<film::Splat> splats;
  for (uint64_t i = 0; i < kPathsPerUnit; ++i) {
    for (const float share : {1.0f, 0.5f}) {
      const int32_t x = at(random), y = at(random);
      splats.push_back({x, y, Radiance(share / 1.5f * truth(x, y) * float(kSide * kSide))});
    }
  }
  return splats;
}

std::vector<Radiance> render(int threads) {
  film::SplatPlane plane(kRegion);
  std::atomic<uint32_t> next{0};
  const auto work = [&] {
    film::Counters counters;
    // Pairs of units in the wrong order.
    for (uint32_t i = next++; i < kUnits; i = next++) plane.merge(i ^ 1u, kPathsPerUnit, trace(i ^ 1u), &counters);
  };
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(plane.paths(), kUnits * kPathsPerUnit);
  return plane.mean();
}

TEST(Splats, HaveTheSameBitsForAnyNumberOfThreads) {
  const std::vector<Radiance> one = render(1);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(render(threads), one) << threads;
}

TEST(Splats, AreNormalisedByThePathsOfTheWholeFrame) {
  const std::vector<Radiance> image = render(2);
  double sum = 0.0, expected = 0.0;
  for (int32_t y = kRegion.y0; y < kRegion.y1; ++y) {
    for (int32_t x = kRegion.x0; x < kRegion.x1; ++x) {
      const size_t i = size_t(y - kRegion.y0) * size_t(kRegion.width()) + size_t(x - kRegion.x0);
      // 256 splats per pixel, of two strengths: 6.6 % at one sigma.
      EXPECT_NEAR(image[i].x, truth(x, y), 0.35f * truth(x, y));
      sum += image[i].x;
      expected += truth(x, y);
    }
  }
  EXPECT_NEAR(sum, expected, 0.05 * expected);
}

TEST(Splats, WaitForTheUnitsBeforeThem) {
  film::SplatPlane plane(kRegion);
  film::Counters counters;
  plane.merge(1, 10, {{3, 2, Radiance(4.0f)}}, &counters);
  EXPECT_EQ(plane.paths(), 0u);
  EXPECT_EQ(plane.mean()[0], Radiance(0.0f));
  plane.merge(0, 6, {{3, 2, Radiance(std::numeric_limits<float>::infinity())}, {2, 2, Radiance(1.0f)}}, &counters);
  EXPECT_EQ(plane.paths(), 16u);
  EXPECT_EQ(plane.mean()[0], Radiance(0.25f));
  EXPECT_EQ(counters.nonfinite_radiance, 1u);
}

}  // namespace
}  // namespace gradus
