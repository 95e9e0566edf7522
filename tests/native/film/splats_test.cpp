// Splats of work units are added in a fixed order and normalised by all paths. A small light tracer stands in for a
// real one.
#include "film/splats.h"

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "base/error.h"
#include "support/refusal.h"

namespace gradus::splats_test {
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

// Traces and adds units in an arena of so many threads.
void add_splats(int threads, uint32_t units, const film::TraceSplats& traced, film::Film* film) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena(threads).execute(
      [&] { film::add_splats(units, traced, film, film->channels.find("Light"), &film->counters); });
}

std::vector<Rgb> render(int threads) {
  film::Film film = make_film();
  const auto traced = [&](uint32_t unit) {
    if (unit % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the next unit ends before this one
    return film::SplatUnit{0, kPathsPerUnit, trace(unit)};
  };
  add_splats(threads, kUnits, traced, &film);
  EXPECT_EQ(film.channels.find("Light")->paths[0], kUnits * kPathsPerUnit);
  return mean(film);
}

TEST(Splats, HaveTheSameBitsForAnyNumberOfThreads) {
  const std::vector<Rgb> one = render(1);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(render(threads), one) << threads;
}

TEST(Splats, NoFurtherUnitsBeginWhileTheFirstIsSlow) {
  constexpr int kThreads = 3;
  constexpr uint32_t kBound = kThreads * film::kSplatUnitsPerThread;
  std::atomic<uint32_t> begun{0};
  uint32_t begun_meanwhile = 0;
  const auto traced = [&](uint32_t unit) {
    ++begun;
    if (unit == 0) {
      for (int i = 0; i < 10000 && begun < kBound; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      begun_meanwhile = begun;
    }
    return film::SplatUnit{0, 1, {}};
  };
  film::Film film = make_film();
  add_splats(kThreads, kUnits, traced, &film);
  EXPECT_EQ(begun_meanwhile, kBound);
  EXPECT_EQ(begun, kUnits);
  EXPECT_EQ(film.channels.find("Light")->paths[0], kUnits);
}

TEST(Splats, AUnitThatFailsEndsTheOthers) {
  film::Film film = make_film();
  const auto traced = [&](uint32_t unit) {
    if (unit == 5) throw invalid_argument("no light");
    return film::SplatUnit{0, 1, trace(unit)};
  };
  EXPECT_EQ(test::refusal_of([&] { add_splats(3, kUnits, traced, &film); }), "no light");
  EXPECT_LE(film.channels.find("Light")->paths[0], 5u);
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

TEST(Splats, OutsideOfTheRegionOrNotFiniteAreLeftOut) {
  film::Film film = make_film();
  const std::vector<film::SplatUnit> units{{0, 6, {{3, 2, Vec4(kInfinity)}, {2, 2, Vec4(1.0f)}}},
                                           {0, 10, {{3, 2, Vec4(4.0f)}}}};
  add_splats(
      2, 2, [&](uint32_t unit) { return units[unit]; }, &film);
  EXPECT_EQ(film.channels.find("Light")->paths[0], 16u);
  EXPECT_EQ(mean(film)[0], Rgb(0.25f));
  EXPECT_EQ(film.counters.nonfinite_feature, 1u);
}

TEST(Splats, OfHalfBuffersAreDividedByTheirOwnPaths) {
  film::Film film = make_film(true);
  const std::vector<film::SplatUnit> units{{0, 4, {{3, 2, Vec4(4.0f)}}}, {1, 12, {{3, 2, Vec4(24.0f)}}}};
  add_splats(
      2, 2, [&](uint32_t unit) { return units[unit]; }, &film);
  EXPECT_EQ(mean(film, {0, 1})[0], Rgb(1.0f));
  EXPECT_NEAR(mean(film, {1, 2})[0].x, 2.0f, 1e-6f);
  EXPECT_EQ(mean(film)[0], Rgb(1.75f));
}

TEST(Splats, OnlyEnterChannelsThatTakeThem) {
  film::Film film = make_film();
  film.channels.add({"Data", 1}, size_t(kRegion.area()));
  const auto traced = [](uint32_t) { return film::SplatUnit{}; };
  EXPECT_THROW(film::add_splats(1, traced, &film, film.channels.find("Data"), &film.counters), Error);
}

}  // namespace
}  // namespace gradus::splats_test
