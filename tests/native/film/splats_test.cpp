// Splats of work units are merged in a fixed order and normalised by all paths. A small light tracer stands in for a
// real one.
#include "film/splats.h"

#include <atomic>
#include <limits>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "base/error.h"

namespace gradus {
namespace {

constexpr Region kRegion{3, 2, 11, 7};
constexpr uint32_t kUnits = 64;
constexpr uint64_t kPathsPerUnit = 512;

float truth(int32_t x, int32_t y) { return 1.0f + 0.1f * float(x) + 0.3f * float(y); }

// Traces light paths that splat uniformly around the region, each with a second splat, as of a longer path, of half the
// value.
std::vector<film::Splat> trace(uint32_t unit) {
  constexpr int kSide = 16;
  std::mt19937 random(unit);
  std::uniform_int_distribution<int32_t> at(0, kSide - 1);
  std::vector<film::Splat> splats;
  for (uint64_t i = 0; i < kPathsPerUnit; ++i) {
    for (const float share : {1.0f, 0.5f}) {
      const int32_t x = at(random), y = at(random);
      splats.push_back({x, y, Vec4(share / 1.5f * truth(x, y) * float(kSide * kSide))});
    }
  }
  return splats;
}

// Returns a film with one channel for splats, "Light", in half-buffers or not.
film::Film make_film(bool in_halves = false) {
  film::Film film(16, 16, kRegion, 3, 1, false);
  film.channels.add({"Light", 3, film::ValueType::kRadiance, film::Normalisation::kAllPaths, in_halves, true},
                    size_t(kRegion.area()));
  return film;
}

std::vector<Rgb> mean(const film::Film& film, film::HalfRange halves = {}) {
  const auto pixels = size_t(kRegion.area());
  std::vector<Rgb> image(pixels);
  film::read_channel(film, *film.channels.find("Light"), halves, 0, pixels, 1.0f, &image[0].x);
  return image;
}

std::vector<Rgb> render(int threads) {
  film::Film film = make_film();
  film::Channel* const light = film.channels.find("Light");
  film::SplatQueue queue(&film, light);
  std::atomic<uint32_t> next{0};
  const auto work = [&] {
    film::Counters counters;
    // Merges the two units of each pair in the wrong order.
    for (uint32_t i = next++; i < kUnits; i = next++) queue.merge(i ^ 1u, 0, kPathsPerUnit, trace(i ^ 1u), &counters);
  };
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(light->paths[0], kUnits * kPathsPerUnit);
  return mean(film);
}

TEST(Splats, HaveTheSameBitsForAnyNumberOfThreads) {
  const std::vector<Rgb> one = render(1);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(render(threads), one) << threads;
}

TEST(Splats, AreNormalisedByThePathsOfTheWholeFrame) {
  const std::vector<Rgb> image = render(2);
  double sum = 0.0, expected = 0.0;
  for (int32_t y = kRegion.y0; y < kRegion.y1; ++y) {
    for (int32_t x = kRegion.x0; x < kRegion.x1; ++x) {
      const size_t i = size_t(y - kRegion.y0) * size_t(kRegion.width()) + size_t(x - kRegion.x0);
      // 256 splats per pixel with two values: a standard deviation of 6.6 %.
      EXPECT_NEAR(image[i].x, truth(x, y), 0.35f * truth(x, y));
      sum += image[i].x;
      expected += truth(x, y);
    }
  }
  EXPECT_NEAR(sum, expected, 0.05 * expected);
}

TEST(Splats, WaitForTheUnitsBeforeThem) {
  film::Film film = make_film();
  film::Channel* const light = film.channels.find("Light");
  film::SplatQueue queue(&film, light);
  film::Counters counters;
  queue.merge(1, 0, 10, {{3, 2, Vec4(4.0f)}}, &counters);
  EXPECT_EQ(light->paths[0], 0u);
  EXPECT_EQ(mean(film)[0], Rgb(0.0f));
  queue.merge(0, 0, 6, {{3, 2, Vec4(std::numeric_limits<float>::infinity())}, {2, 2, Vec4(1.0f)}}, &counters);
  EXPECT_EQ(light->paths[0], 16u);
  EXPECT_EQ(mean(film)[0], Rgb(0.25f));
  EXPECT_EQ(counters.nonfinite_feature, 1u);
}

TEST(Splats, OfHalfBuffersAreDividedByTheirOwnPaths) {
  film::Film film = make_film(true);
  film::SplatQueue queue(&film, film.channels.find("Light"));
  queue.merge(0, 0, 4, {{3, 2, Vec4(4.0f)}}, &film.counters);
  queue.merge(1, 1, 12, {{3, 2, Vec4(24.0f)}}, &film.counters);
  EXPECT_EQ(mean(film, {0, 1})[0], Rgb(1.0f));
  EXPECT_NEAR(mean(film, {1, 2})[0].x, 2.0f, 1e-6f);
  EXPECT_EQ(mean(film)[0], Rgb(1.75f));
}

TEST(Splats, OnlyEnterChannelsThatTakeThem) {
  film::Film film = make_film();
  film.channels.add({"Data", 1}, size_t(kRegion.area()));
  EXPECT_THROW(film::SplatQueue(&film, film.channels.find("Data")), Error);
}

}  // namespace
}  // namespace gradus
