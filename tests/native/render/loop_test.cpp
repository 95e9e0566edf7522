// The loop: determinism, resume, regions, time limit, cancel, progress, and reading during the render.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include "render/batches.h"
#include "render/fake_integrator.h"
#include "render/resume.h"
#include "support/refusal.h"

namespace gradus::loop_test {
namespace {

using namespace test;

constexpr uint64_t bit(uint32_t pass) { return uint64_t{1} << pass; }

std::string failure_of(const GradusSettings& settings, const std::shared_ptr<const film::Film>& resumed = nullptr) {
  return refusal_of([&] { start(settings, fake_factory(), resumed); });
}

TEST(Batches, GrowThenStayAndAlignAgainAfterResume) {
  EXPECT_EQ(render::batch_end(0, 64), 1u);
  EXPECT_EQ(render::batch_end(1, 64), 2u);
  EXPECT_EQ(render::batch_end(2, 64), 4u);
  EXPECT_EQ(render::batch_end(8, 64), 16u);
  EXPECT_EQ(render::batch_end(16, 64), 32u);
  EXPECT_EQ(render::batch_end(16, 20), 20u);
  EXPECT_EQ(render::batch_end(20, 64), 32u);
  EXPECT_EQ(render::batch_end(3, 64), 4u);
}

// Adaptive sample counts are corrected at least three times; the T-GPT paper uses four to eight batches.
TEST(Batches, AreAQuarterOfARenderAtMost) {
  for (const uint32_t samples : {64u, 100u, 1024u}) {
    for (uint32_t begin = 0, end = 0; begin < samples; begin = end) {
      end = render::batch_end(begin, samples);
      EXPECT_LE(end - begin, samples / 4);
    }
  }
}

TEST(L1_Threads, SamplesHaveTheSameBitsForAnyNumberOfThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 8);
  GradusSettings settings = small_settings(150, 90, 20);
  settings.passes |= bit(GRADUS_PASS_DEPTH) | bit(GRADUS_PASS_VECTOR);
  std::shared_ptr<const film::Film> first;
  std::vector<float> combined;
  for (const uint32_t threads : {1u, 2u, 3u, 7u}) {
    settings.threads = threads;
    auto render = start(settings);
    ASSERT_TRUE(render->wait(-1.0));
    const auto image = read(*render, GRADUS_PASS_COMBINED, {0, 0, 150, 90});
    if (!first) {
      first = render->film();
      combined = image;
    }
    EXPECT_TRUE(same_samples(*render->film(), *first)) << threads;
    EXPECT_EQ(image, combined) << threads;
  }
}

TEST(L3_Resume, SixteenAndFortyEightSamplesHaveTheBitsOfSixtyFour) {
  const auto whole = rendered(small_settings(70, 50, 64));
  const auto resumed = rendered(small_settings(70, 50, 64), rendered(small_settings(70, 50, 16)));
  EXPECT_TRUE(same_samples(*whole, *resumed));
  // A film can be resumed at any sample number, not only where batches end.
  EXPECT_TRUE(same_samples(*whole, *rendered(small_settings(70, 50, 64), rendered(small_settings(70, 50, 21)))));
}

TEST(L3_Resume, RefusesOtherFilms) {
  const auto film = rendered(small_settings(40, 30, 8));
  GradusSettings other = small_settings(40, 30, 16);
  other.seed = 1;
  EXPECT_NE(failure_of(other, film), "");
  other = small_settings(41, 30, 16);
  EXPECT_NE(failure_of(other, film), "");
  other = small_settings(40, 30, 4);
  EXPECT_NE(failure_of(other, film), "");
  other = small_settings(40, 30, 16);
  other.passes |= bit(GRADUS_PASS_MIST);
  EXPECT_NE(failure_of(other, film), "");
  EXPECT_EQ(failure_of(small_settings(40, 30, 16), film), "");
}

TEST(L3_Merge, AddsTheSamplesOfTwoRanges) {
  const auto whole = rendered(small_settings(40, 30, 64));
  GradusSettings late = small_settings(40, 30, 48);
  late.first_sample = 16;
  film::Film merged = *rendered(small_settings(40, 30, 16));
  render::merge_films(&merged, *rendered(late));
  EXPECT_EQ(merged.settings.samples, 64u);
  EXPECT_EQ(merged.count, whole->count);
  for (int half = 0; half < film::kHalves; ++half) {
    for (size_t i = 0; i < merged.count[half].size(); ++i) {
      EXPECT_NEAR(merged.components[0].primal[half][i].x, whole->components[0].primal[half][i].x, 1e-5f * 64.0f);
    }
  }
  film::Film again = *whole;
  EXPECT_THROW(render::merge_films(&again, *whole), Error);  // the same samples
}

std::shared_ptr<const film::Film> rendered_range(uint32_t first, uint32_t count) {
  GradusSettings settings = small_settings(40, 30, count);
  settings.first_sample = first;
  return rendered(settings);
}

// Regression: only the sum of the sample counts was stored, so that samples 32 to 47 were added twice.
TEST(L3_Merge, RangesWithAGapStaySeparate) {
  film::Film merged = *rendered_range(0, 16);
  render::merge_films(&merged, *rendered_range(32, 16));
  EXPECT_EQ(merged.samples.list(), (std::vector<film::SampleRange>{{0, 16}, {32, 48}}));
  EXPECT_THROW(render::merge_films(&merged, *rendered_range(40, 8)), Error);
  EXPECT_EQ(failure_of(small_settings(40, 30, 64), std::make_shared<const film::Film>(merged)),
            "the film lacks samples 16 to 31: render and merge these first");
  render::merge_films(&merged, *rendered_range(16, 16));
  EXPECT_EQ(merged.samples.list(), (std::vector<film::SampleRange>{{0, 48}}));
  const auto resumed = rendered(small_settings(40, 30, 64), std::make_shared<const film::Film>(merged));
  EXPECT_EQ(resumed->count, rendered_range(0, 64)->count);
  EXPECT_EQ(resumed->samples.list(), (std::vector<film::SampleRange>{{0, 64}}));
}

// A time limit ends a film before the requested samples: the taken samples count.
TEST(L3_Merge, AFilmThatEndedEarlyLeavesItsOtherSamplesFree) {
  GradusSettings settings = small_settings(40, 30, 1u << 20);
  settings.time_limit = 0.02f;
  film::Film early = *rendered(settings);
  const uint32_t end = early.samples.list().front().end;
  ASSERT_LT(end, 1u << 20);
  settings.first_sample = end;
  EXPECT_NO_THROW(render::merge_films(&early, *rendered(settings)));
  EXPECT_EQ(early.samples.list().size(), 1u);
}

TEST(L3_Border, SamplesOfARegionAreThoseOfTheFullFrame) {
  GradusSettings settings = small_settings(160, 120, 8);
  settings.reconstruction = GRADUS_RECONSTRUCTION_L1;
  const auto full = start(settings);
  full->wait(-1.0);
  const uint32_t region[4] = {60, 50, 97, 83};
  std::copy(region, region + 4, settings.region);
  const auto part = start(settings);
  part->wait(-1.0);
  const Region r{60, 50, 97, 83};
  const film::Film &a = *full->film(), &b = *part->film();
  EXPECT_EQ(b.region.x0, 60 - 35);
  EXPECT_EQ(b.region.y1, 83 + 35);
  EXPECT_EQ(b.region.x1, 97 + 35);
  const std::vector<float> noisy = read(*full, GRADUS_PASS_NOISY_IMAGE, {0, 0, 160, 120});
  const std::vector<float> noisy_part = read(*part, GRADUS_PASS_NOISY_IMAGE, r);
  const std::vector<float> combined = read(*full, GRADUS_PASS_COMBINED, {0, 0, 160, 120});
  const std::vector<float> combined_part = read(*part, GRADUS_PASS_COMBINED, r);
  for (int32_t y = r.y0; y < r.y1; ++y) {
    for (int32_t x = r.x0; x < r.x1; ++x) {
      const size_t i = 4 * (size_t(y) * 160 + x), k = 4 * (size_t(y - r.y0) * r.width() + size_t(x - r.x0));
      ASSERT_EQ(noisy[i], noisy_part[k]);
      ASSERT_NEAR(combined[i], combined_part[k], 1e-3f * combined[i]);
    }
  }
  EXPECT_EQ(a.components[0].primal[0][a.index(70, 60)], b.components[0].primal[0][b.index(70, 60)]);
}

TEST(G8_Progress, IsInTheUnitIntervalNeverFallsAndEndsAtOne) {
  auto render = start(small_settings(96, 64, 64), fake_factory([](FakeIntegrator* fake) {
                        fake->before = [](const integrator::WorkUnit&) {
                          std::this_thread::sleep_for(std::chrono::microseconds(200));
                        };
                      }));
  float last = 0.0f;
  uint32_t version = 0, samples = 0;
  while (!render->wait(0.001)) {
    const GradusProgress p = render->progress();
    EXPECT_GE(p.fraction, last);
    EXPECT_LE(p.fraction, 1.0f);
    EXPECT_GE(p.version, version);
    EXPECT_GE(p.samples_done, samples);
    last = p.fraction;
    version = p.version;
    samples = p.samples_done;
  }
  const GradusProgress end = render->progress();
  EXPECT_EQ(end.fraction, 1.0f);
  EXPECT_EQ(end.phase, uint32_t{GRADUS_PHASE_DONE});
  EXPECT_EQ(end.samples_done, 64u);
  EXPECT_GT(end.version, version);
  EXPECT_GT(end.memory_bytes, 96u * 64u * 160u);
  EXPECT_GT(end.peak_memory_bytes, end.memory_bytes);
}

TEST(K2_Cancel, EndsWithinAQuarterSecondAndStaysReadable) {
  std::atomic<int> tiles{0};
  auto render = start(small_settings(512, 512, 100000), fake_factory([&tiles](FakeIntegrator* fake) {
                        fake->before = [&tiles](const integrator::WorkUnit&) { ++tiles; };
                      }));
  while (tiles < 600) std::this_thread::yield();
  const auto began = std::chrono::steady_clock::now();
  render->cancel();
  ASSERT_TRUE(render->wait(10.0));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::milliseconds(250));
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(render->progress().phase, uint32_t{GRADUS_PHASE_CANCELLED});
  EXPECT_LT(render->progress().fraction, 1.0f);
  const std::vector<float> noisy = read(*render, GRADUS_PASS_COMBINED, {0, 0, 512, 512});
  EXPECT_NEAR(noisy[0], fake_truth(0, 0), 0.51f);
  EXPECT_EQ(nlohmann::json::parse(render->stats_json())["stopped"], "cancelled");
}

TEST(K3_Cancel, ManyCancelsThenARenderHasTheBitsOfAFreshOne) {
  const auto fresh = rendered(small_settings(64, 48, 8));
  for (int i = 0; i < 100; ++i) start(small_settings(64, 48, 1000))->cancel();
  EXPECT_TRUE(same_samples(*fresh, *rendered(small_settings(64, 48, 8))));
}

TEST(Loop, CanBeReadWhileSampling) {
  GradusSettings settings = small_settings(128, 96, 400);
  settings.passes |= bit(GRADUS_PASS_NORMAL) | bit(GRADUS_PASS_VARIANCE) | bit(GRADUS_PASS_GRADIENT_X);
  auto render = start(settings);
  const Region all{0, 0, 128, 96};
  int reads = 0;
  while (!render->wait(0.0)) {
    for (const uint32_t pass : {GRADUS_PASS_COMBINED, GRADUS_PASS_NOISY_IMAGE}) {
      for (const float v : read(*render, pass, all)) ASSERT_TRUE(std::isfinite(v));
    }
    ++reads;
  }
  EXPECT_GT(reads, 0);
  for (const uint32_t pass : {GRADUS_PASS_NORMAL, GRADUS_PASS_VARIANCE, GRADUS_PASS_GRADIENT_X})
    EXPECT_NO_THROW(read(*render, pass, all));
  std::vector<float> pixels(7);
  EXPECT_THROW(render->read_pass(GRADUS_PASS_COMBINED, pixels.data(), pixels.size()), Error);
  EXPECT_THROW(read(*render, GRADUS_PASS_MIST, all), Error);
}

// Regression: the reader followed a sampling thread from tile to tile and waited for the whole batch of each: the user
// interface froze for seconds.
TEST(Loop, ReadingDoesNotWaitForABatch) {
  GradusSettings settings = small_settings(70, 50, 32);
  settings.passes |= bit(GRADUS_PASS_VARIANCE);
  std::atomic<bool> released{false}, in_second_batch{false}, ended_by_itself{false};
  auto render = start(settings, fake_factory([&](FakeIntegrator* fake) {
                        fake->before = [&](const integrator::WorkUnit& unit) {
                          if (unit.first_sample == 0) return;
                          in_second_batch = true;
                          for (int ms = 0; ms < 20000 && !released; ++ms)
                            std::this_thread::sleep_for(std::chrono::milliseconds(1));
                          ended_by_itself = ended_by_itself || !released;
                        };
                      }));
  while (!in_second_batch) std::this_thread::yield();
  const Region all{0, 0, 70, 50};
  for (const uint32_t pass : {GRADUS_PASS_COMBINED, GRADUS_PASS_NOISY_IMAGE}) {
    EXPECT_EQ(read(*render, pass, all), read(*start_and_wait(small_settings(70, 50, 1)), GRADUS_PASS_NOISY_IMAGE, all));
  }
  EXPECT_THROW(read(*render, GRADUS_PASS_VARIANCE, all), Error);
  EXPECT_FALSE(ended_by_itself) << "the reader waited for a batch";
  released = true;
  ASSERT_TRUE(render->wait(20.0));
  const auto whole = start_and_wait(settings);
  for (const uint32_t pass : {GRADUS_PASS_COMBINED, GRADUS_PASS_NOISY_IMAGE, GRADUS_PASS_VARIANCE}) {
    EXPECT_EQ(read(*render, pass, all), read(*whole, pass, all));
  }
}

// Only a part of the film is delivered, and a tile in the middle of a batch has the samples taken so far.
TEST(Loop, AfterACancelThePictureHasTheSamplesOfTheFilm) {
  GradusSettings settings = small_settings(160, 120, 100000);
  const uint32_t region[4] = {60, 50, 97, 83};
  std::copy(region, region + 4, settings.region);
  const Region part{60, 50, 97, 83};
  auto render = start(settings);
  while (render->progress().samples_done < 2) std::this_thread::yield();
  render->cancel();
  ASSERT_TRUE(render->wait(10.0));
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, part), read(*render, GRADUS_PASS_NOISY_IMAGE, part));
}

TEST(Loop, StopsByTimeAndDeliversTheReconstruction) {
  GradusSettings settings = small_settings(64, 64, 1000000);
  settings.time_limit = 0.3f;
  auto render = start(settings);
  ASSERT_TRUE(render->wait(20.0));
  EXPECT_EQ(render->outcome(nullptr), GRADUS_OK);
  const auto stats = nlohmann::json::parse(render->stats_json());
  EXPECT_EQ(stats["stopped"], "time");
  EXPECT_LT(stats["seconds"]["sample"], 2.0);
  EXPECT_EQ(render->progress().phase, uint32_t{GRADUS_PHASE_DONE});
}

// Returns the seconds of sampling with a time limit, where each sample of the single tile takes `sample` seconds.
double limited_seconds(double limit, double sample, const std::shared_ptr<const film::Film>& resumed = nullptr) {
  GradusSettings settings = small_settings(8, 8, 100000);
  settings.time_limit = float(limit);
  const auto slow = fake_factory([sample](FakeIntegrator* fake) {
    fake->before = [sample](const integrator::WorkUnit& unit) {
      std::this_thread::sleep_for(std::chrono::duration<double>(sample * unit.count));
    };
  });
  auto render = start(settings, slow, resumed);
  render->wait(20.0);
  return nlohmann::json::parse(render->stats_json())["seconds"]["sample"];
}

// Regression: the sample that crosses the limit was taken, however far beyond the limit it ends.
TEST(Loop, ATimeLimitIsMetWithinHalfASample) {
  EXPECT_LT(limited_seconds(0.65, 0.2), 0.75);  // three samples
  EXPECT_GT(limited_seconds(0.75, 0.2), 0.75);  // four
}

// Regression: the sampling rate was computed from all samples, including those of the resumed film.
TEST(Loop, ATimeLimitHoldsForAResumedRender) {
  EXPECT_LT(limited_seconds(0.3, 0.05, rendered(small_settings(8, 8, 64))), 0.45);
}

// Regression: the stats reported the bias of the planned reconstruction.
TEST(Loop, TheNoisyImageThatThePilotChoosesIsUnbiased) {
  GradusSettings settings = small_settings(64, 64, 8);
  settings.integrator = GRADUS_INTEGRATOR_AUTO;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L1;
  auto render = start(settings, fake_factory([](FakeIntegrator* fake) { fake->noise = 0.0f; }));
  ASSERT_TRUE(render->wait(20.0));
  const auto stats = nlohmann::json::parse(render->stats_json());
  EXPECT_EQ(stats["reconstruction"], "none");
  EXPECT_TRUE(stats["unbiased"]);
}

TEST(Loop, StopsBlocksByNoise) {
  GradusSettings settings = small_settings(128, 64, 256);
  settings.noise_threshold = 0.05f;
  auto render = start(settings, fake_factory([](FakeIntegrator* fake) { fake->noise = 0.5f; }));
  ASSERT_TRUE(render->wait(20.0));
  const film::Film& film = *render->film();
  const auto stats = nlohmann::json::parse(render->stats_json());
  EXPECT_EQ(stats["stopped"], "noise");
  EXPECT_FALSE(stats["unbiased"]);
  uint32_t minimum = UINT32_MAX, maximum = 0;
  for (size_t i = 0; i < film.count[0].size(); ++i) {
    minimum = std::min(minimum, film::samples_at(film, i));
    maximum = std::max(maximum, film::samples_at(film, i));
  }
  EXPECT_GE(minimum, 16u);
  EXPECT_LT(maximum, 256u);
  // The relative error of the picture is near the threshold or below.
  const std::vector<float> image = read(*render, GRADUS_PASS_COMBINED, {0, 0, 128, 64});
  double error = 0.0, signal = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 128; ++x) {
      const double d = image[4 * (size_t(y) * 128 + x)] - fake_truth(x, y);
      error += d * d;
      signal += fake_truth(x, y) * fake_truth(x, y) + 1e-3;
    }
  }
  EXPECT_LT(std::sqrt(error / signal), 0.05);
}

TEST(Loop, FailuresOfTheIntegratorBecomeTheOutcome) {
  const auto failing = [](FakeIntegrator* fake) {
    fake->before = [](const integrator::WorkUnit& unit) {
      if (unit.first_sample >= 4) throw std::runtime_error("the light is broken");
    };
  };
  auto render = start(small_settings(64, 48, 16), fake_factory(failing));
  ASSERT_TRUE(render->wait(10.0));
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_ERROR_UNKNOWN);
  EXPECT_EQ(text, "the light is broken");
  EXPECT_EQ(render->progress().phase, uint32_t{GRADUS_PHASE_FAILED});
}

// Regression: the code also meant "still running", so that it was reported as UNKNOWN.
TEST(Loop, AnInvalidOperationIsReportedAsSuch) {
  const auto failing = [](FakeIntegrator* fake) {
    fake->before = [](const integrator::WorkUnit&) { throw invalid_operation("the film is shut"); };
  };
  auto render = start(small_settings(64, 48, 16), fake_factory(failing));
  ASSERT_TRUE(render->wait(10.0));
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_EQ(text, "the film is shut");
}

TEST(Loop, RefusesCallsOutOfOrder) {
  auto render = start(small_settings(256, 256, 1000));
  EXPECT_FALSE(render->wait(0.0));
  EXPECT_THROW(render->outcome(nullptr), Error);
  EXPECT_THROW(render->stats_json(), Error);
  EXPECT_THROW(render->film(), Error);
}

TEST(Loop, L2IsCloserToTheTruthThanTheNoisyImage) {
  auto render = start(small_settings(96, 64, 8));
  render->wait(-1.0);
  const auto combined = read(*render, GRADUS_PASS_COMBINED, {0, 0, 96, 64});
  const auto noisy = read(*render, GRADUS_PASS_NOISY_IMAGE, {0, 0, 96, 64});
  double a = 0.0, b = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const size_t i = 4 * (size_t(y) * 96 + x);
      a += std::pow(combined[i] - fake_truth(x, y), 2);
      b += std::pow(noisy[i] - fake_truth(x, y), 2);
      EXPECT_EQ(combined[i + 3], 1.0f);
    }
  }
  EXPECT_LT(a, 0.1 * b);
}

TEST(Loop, AlphaAndExposureReachTheImage) {
  GradusSettings settings = small_settings(32, 32, 4);
  settings.film_transparent = 1;
  settings.film_exposure = 2.0f;
  for (const uint32_t reconstruction :
       {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1}) {
    settings.reconstruction = reconstruction;
    auto render = start(settings);
    render->wait(-1.0);
    const auto image = read(*render, GRADUS_PASS_COMBINED, {0, 0, 32, 32});
    EXPECT_NEAR(image[3], 0.75f, 1e-3f) << reconstruction;
    double mean = 0.0;
    for (size_t i = 0; i < image.size(); i += 4) mean += image[i] / (32.0 * 32.0);
    EXPECT_NEAR(mean, 2.0 * 0.5, 0.05) << reconstruction;
  }
}

}  // namespace
}  // namespace gradus::loop_test
