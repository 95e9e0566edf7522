// Previews while a render takes its samples; the result is the same without them.
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "output/upsample.h"
#include "render/fake_integrator.h"
#include "render/plan.h"
#include "render/preview.h"
#include "render/refresh_rule.h"
#include "scene/device.h"
#include "support/path_scene.h"

namespace gradus::preview_test {
namespace {

using namespace test;

constexpr uint32_t kForever = 1u << 24;  // samples that no test completes

TEST(RefreshRule, FollowsItsOwnCost) {
  render::RefreshRule rule;
  rule.expect(1.0);
  EXPECT_FALSE(rule.is_due(1.0, 0.1)) << "the render will take 10 s: too short to give 1 s away at once";
  EXPECT_TRUE(rule.is_due(1.0, 0.05)) << "20 s: long enough, and it need not wait for them";
  EXPECT_TRUE(rule.is_due(4.0, 0.4)) << "the first picture is not delayed";
  rule.done(4.0, 2.0);
  EXPECT_FALSE(rule.is_due(43.9, 1.0));
  EXPECT_TRUE(rule.is_due(44.0, 1.0));
  EXPECT_TRUE(render::RefreshRule().is_due(0.0, 0.0)) << "nothing is known";
}

bool is_quarter(const integrator::Integrator& integrator, const GradusSettings& settings) {
  const auto* fake = dynamic_cast<const FakeIntegrator*>(&integrator);
  return fake != nullptr && fake->settings.width < settings.width;
}

Region region_of(const GradusSettings& s) {
  if (s.region[2] == 0) return {0, 0, int32_t(s.width), int32_t(s.height)};
  return {int32_t(s.region[0]), int32_t(s.region[1]), int32_t(s.region[2]), int32_t(s.region[3])};
}

// Reads previews like a window, until the render ends.
void watch(render::Render* render, const Region& region) {
  do {
    for (const uint32_t pass : {GRADUS_PASS_COMBINED, GRADUS_PASS_NOISY_IMAGE}) {
      for (const float v : read(*render, pass, region)) ASSERT_TRUE(std::isfinite(v));
    }
  } while (!render->wait(0.0005));
}

template <class Condition>
void wait_for(Condition&& condition) {
  for (int ms = 0; ms < 20000 && !condition(); ++ms) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(condition());
}

nlohmann::json stats_of(const render::Render& render) { return nlohmann::json::parse(render.stats_json()); }

// Returns an integrator that is slow enough to be watched.
render::IntegratorFactory slow_factory(std::chrono::microseconds per_tile = std::chrono::microseconds(300)) {
  return fake_factory([per_tile](FakeIntegrator* fake) {
    fake->before = [per_tile](const integrator::WorkUnit&) { std::this_thread::sleep_for(per_tile); };
  });
}

GradusSettings settings_of(uint32_t width, uint32_t height, uint32_t samples, uint32_t integrator,
                           uint32_t reconstruction) {
  GradusSettings settings = small_settings(width, height, samples);
  settings.integrator = integrator;
  settings.reconstruction = reconstruction;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}

TEST(Preview, WithoutAReaderNoneIsMade) {
  const GradusSettings settings = settings_of(96, 64, 32, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2);
  std::atomic<int> quarters{0};
  const auto render =
      start(settings, fake_factory([&](FakeIntegrator* fake) { quarters += is_quarter(*fake, settings) ? 1 : 0; }));
  while (!render->wait(0.0005)) read(*render, GRADUS_PASS_NOISY_IMAGE, region_of(settings));
  read(*render, GRADUS_PASS_COMBINED, region_of(settings));
  EXPECT_EQ(quarters, 0);
  const auto stats = stats_of(*render);
  EXPECT_EQ(stats["seconds"]["preview"], 0.0);
  EXPECT_EQ(stats["cpu_seconds"]["preview"], 0.0);
}

struct Kind {
  const char* name;
  uint32_t integrator, reconstruction;
  float noise_threshold = 0.0f;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }  // valgrind reports the padding of the struct

class WatchedRender : public ::testing::TestWithParam<Kind> {
 protected:
  GradusSettings settings(uint32_t width, uint32_t height, uint32_t samples) const {
    GradusSettings s = settings_of(width, height, samples, GetParam().integrator, GetParam().reconstruction);
    s.noise_threshold = GetParam().noise_threshold;
    return s;
  }
};

TEST_P(WatchedRender, HasTheBitsOfAnUnwatchedOne) {
  GradusSettings settings = this->settings(100, 70, 48);
  const Region all = region_of(settings);
  const auto unwatched = start_and_wait(settings);
  for (const uint32_t threads : {1u, 2u}) {
    settings.threads = threads;
    const auto render = start(settings, slow_factory());
    watch(render.get(), all);
    ASSERT_EQ(render->outcome(nullptr), GRADUS_OK);
    EXPECT_TRUE(same_samples(*render->film(), *unwatched->film())) << threads;
    for (const uint32_t pass : {GRADUS_PASS_COMBINED, GRADUS_PASS_NOISY_IMAGE, GRADUS_PASS_ERROR}) {
      EXPECT_EQ(read(*render, pass, all), read(*unwatched, pass, all)) << threads << " " << pass;
    }
    const auto watched = stats_of(*render), plain = stats_of(*unwatched);
    const bool shows = GetParam().reconstruction != GRADUS_RECONSTRUCTION_NONE;
    EXPECT_EQ(watched["seconds"]["preview"] > 0.0, shows);
    EXPECT_EQ(watched["rays"], plain["rays"]);
    EXPECT_EQ(watched["stopped"], plain["stopped"]);
  }
}

TEST_P(WatchedRender, MayHaveAnySize) {
  for (const auto& [width, height] :
       {std::pair{1u, 1u}, {2u, 1u}, {1u, 3u}, {3u, 3u}, {1u, 200u}, {200u, 1u}, {17u, 5u}}) {
    const GradusSettings settings = this->settings(width, height, 24);
    const auto render = start(settings, slow_factory());
    watch(render.get(), region_of(settings));
    ASSERT_EQ(render->outcome(nullptr), GRADUS_OK) << width << "x" << height;
    EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, region_of(settings)),
              read(*start_and_wait(settings), GRADUS_PASS_COMBINED, region_of(settings)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, WatchedRender,
    ::testing::Values(Kind{"Noisy", GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_NONE},
                      Kind{"L2", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2},
                      Kind{"L1", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1},
                      Kind{"PathRegularized", GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED},
                      Kind{"Regularized", GRADUS_INTEGRATOR_AUTO, GRADUS_RECONSTRUCTION_REGULARIZED},
                      Kind{"AdaptiveL1", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1, 0.03f},
                      Kind{"AdaptiveRegularized", GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED, 0.03f}),
    [](const ::testing::TestParamInfo<Kind>& info) { return info.param.name; });

TEST(Preview, AResumedRenderIsShownFromItsSamples) {
  const GradusSettings settings = settings_of(96, 64, 48, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2);
  GradusSettings first = settings;
  first.samples = 16;
  std::atomic<int> quarters{0};
  const auto count = [&](FakeIntegrator* fake) {
    quarters += is_quarter(*fake, settings) ? 1 : 0;
    fake->before = [](const integrator::WorkUnit&) { std::this_thread::sleep_for(std::chrono::microseconds(300)); };
  };
  const auto render = start(settings, fake_factory(count), rendered(first));
  watch(render.get(), region_of(settings));
  EXPECT_EQ(quarters, 0) << "there are enough samples for the real thing";
  EXPECT_GT(stats_of(*render)["seconds"]["preview"], 0.0);
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, region_of(settings)),
            read(*start_and_wait(settings), GRADUS_PASS_COMBINED, region_of(settings)));
}

// A batch of 16 samples may take minutes. Here, tiles are slow and pictures are fast, also with sanitizers.
TEST(Preview, ALongBatchDoesNotDelayThePictures) {
  const GradusSettings settings = settings_of(64, 64, kForever, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2);
  const auto render = start(settings, fake_factory([](FakeIntegrator* fake) {
                              fake->before = [](const integrator::WorkUnit& unit) {
                                if (unit.first_sample >= 16)
                                  std::this_thread::sleep_for(std::chrono::milliseconds(200));
                              };
                            }));
  read(*render, GRADUS_PASS_COMBINED, region_of(settings));
  std::map<uint32_t, std::set<uint32_t>> pictures;  // by the samples of whole batches
  wait_for([&] {
    const GradusProgress now = render->progress();
    if (now.samples_done >= 16) pictures[now.samples_done].insert(now.version);
    return pictures[now.samples_done].size() >= 3;  // one may come between two batches
  });
}

// The seconds of sampling are given; those of pictures are measured, so that the speed of the machine does not matter.
TEST(Preview, TakesATwentiethOfTheTime) {
  render::LoopInput input;
  input.settings = settings_of(96, 64, 2, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1);
  const render::Plan plan = render::make_plan(input.settings, *empty_snapshot());
  const std::atomic<bool> stop{false};
  tbb::task_arena arena(2);
  render::Picture picture(plan.delivered, 2);
  render::ProgressTracker tracker;
  render::Preview view(input, plan, stop, &arena, &picture, &tracker);
  view.watch();
  const auto film = rendered(input.settings);
  const auto is_due = [&](double sampled) { return view.refresh_is_due(GRADUS_RECONSTRUCTION_L1, sampled, 0.5); };
  EXPECT_TRUE(is_due(0.0)) << "nothing is known of the first one";
  double sampled = 0.0;
  for (uint32_t i = 1; i <= 5; ++i) {
    const double before = view.seconds();
    view.refresh(film, sampled);
    const double cost = view.seconds() - before;
    EXPECT_GT(cost, 0.0);
    EXPECT_EQ(tracker.version(), i);
    EXPECT_FALSE(is_due(sampled + 19.99 * cost));
    sampled += 20.01 * cost;
    EXPECT_TRUE(is_due(sampled));
  }
}

// A picture of this size takes tens of milliseconds: after the first one, the next would come too late.
TEST(Preview, IsMadeNoMoreOftenThanItPays) {
  GradusSettings settings = settings_of(256, 192, kForever, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1);
  settings.time_limit = 0.25f;
  std::atomic<bool> is_watched{false};
  const auto render = start(settings, fake_factory([&](FakeIntegrator* fake) {
                              fake->before = [&](const integrator::WorkUnit&) {
                                while (!is_watched) std::this_thread::yield();
                                std::this_thread::sleep_for(std::chrono::milliseconds(1));
                              };
                            }));
  read(*render, GRADUS_PASS_COMBINED, region_of(settings));
  is_watched = true;
  render->wait(-1.0);
  EXPECT_GT(stats_of(*render)["seconds"]["preview"], 0.0);
  EXPECT_LE(render->progress().version, 3u) << "the quarter, one of the frame, and what is delivered";
}

// The time limit applies to sampling. A render ends within half a sample of it, so not before two thirds; and a picture
// takes so long that sampling is shorter on any busy machine.
TEST(Preview, DoesNotCountAgainstTheTimeLimit) {
  GradusSettings settings = settings_of(16, 16, kForever, GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED);
  settings.time_limit = 0.1f;
  std::atomic<bool> is_watched{false};
  const auto render = start(settings, fake_factory([&](FakeIntegrator* fake) {
                              while (!is_watched) std::this_thread::yield();  // before sampling begins
                              const bool waits = is_quarter(*fake, settings);
                              fake->before = [waits](const integrator::WorkUnit&) {
                                std::this_thread::sleep_for(std::chrono::milliseconds(waits ? 2000 : 10));
                              };
                            }));
  read(*render, GRADUS_PASS_COMBINED, region_of(settings));
  is_watched = true;
  render->wait(-1.0);
  const auto seconds = stats_of(*render)["seconds"];
  EXPECT_GE(seconds["preview"], 2.0);
  EXPECT_GT(seconds["sample"], 0.66 * 0.1);
  EXPECT_LT(seconds["sample"], 2.0);
}

TEST(Preview, ACancelEndsTheQuarterSizedPicture) {
  const GradusSettings settings =
      settings_of(256, 256, kForever, GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED);
  std::atomic<int> tiles{0};
  const auto render = start(settings, fake_factory([&](FakeIntegrator* fake) {
                              const bool is_slow = is_quarter(*fake, settings);
                              fake->before = [&tiles, is_slow](const integrator::WorkUnit&) {
                                tiles += is_slow ? 1 : 0;
                                std::this_thread::sleep_for(std::chrono::milliseconds(is_slow ? 50 : 1));
                              };
                            }));
  read(*render, GRADUS_PASS_COMBINED, region_of(settings));
  wait_for([&] { return tiles > 0; });
  const auto began = std::chrono::steady_clock::now();
  render->cancel();
  ASSERT_TRUE(render->wait(10.0));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::milliseconds(250));
  EXPECT_EQ(render->outcome(nullptr), GRADUS_ERROR_CANCELLED);
  EXPECT_LT(tiles, 10);  // of 16
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, region_of(settings)),
            read(*render, GRADUS_PASS_NOISY_IMAGE, region_of(settings)));
}

// Regression: a cancel left raw noise, and black where no sample was taken, instead of the picture shown before.
TEST(Preview, ACancelBeforeTheFirstFullPictureKeepsTheQuarterSizedOne) {
  const GradusSettings settings =
      settings_of(256, 192, kForever, GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED);
  const Region all = region_of(settings);
  std::atomic<bool> is_watched{false}, released{false};
  std::atomic<int> tiles{0};
  const auto render = start(settings, fake_factory([&](FakeIntegrator* fake) {
                              while (!is_watched) std::this_thread::yield();  // before sampling begins
                              if (is_quarter(*fake, settings)) return;
                              fake->before = [&](const integrator::WorkUnit&) {
                                if (tiles++ < 4) return;
                                while (!released) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                              };
                            }));
  read(*render, GRADUS_PASS_COMBINED, all);
  is_watched = true;
  wait_for([&] { return tiles > 4; });
  const std::vector<float> seen = read(*render, GRADUS_PASS_COMBINED, all);
  render->cancel();
  released = true;
  ASSERT_TRUE(render->wait(10.0));
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, all), seen);
  const std::vector<float> noisy = read(*render, GRADUS_PASS_NOISY_IMAGE, all),
                           error = read(*render, GRADUS_PASS_ERROR, all);
  int unsampled = 0;
  double estimated = 0.0;
  for (size_t i = 0; i < error.size(); ++i) {
    unsampled += noisy[4 * i + 3] == 0.0f ? 1 : 0;
    ASSERT_GT(seen[4 * i], 0.0f);
    ASSERT_EQ(seen[4 * i + 3], 1.0f);
    ASSERT_GE(error[i], 0.0f);
    estimated += error[i];
  }
  EXPECT_GT(estimated, 0.0) << "that of the quarter";
  EXPECT_GT(unsampled, 0) << "nothing to fill";
}

// A picture from the render's own samples is newer than the quarter-sized one, and stays.
TEST(Preview, ACancelKeepsTheReconstructionThatWasShown) {
  GradusSettings settings = settings_of(96, 64, kForever, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2);
  const auto render = start(settings, slow_factory());
  const Region all = region_of(settings);
  read(*render, GRADUS_PASS_COMBINED, all);
  wait_for([&] { return render->progress().samples_done >= 8; });
  render->cancel();
  ASSERT_TRUE(render->wait(10.0));
  const std::vector<float> combined = read(*render, GRADUS_PASS_COMBINED, all),
                           noisy = read(*render, GRADUS_PASS_NOISY_IMAGE, all);
  double left = 0.0, of_noisy = 0.0, estimated = 0.0;
  const std::vector<float> error = read(*render, GRADUS_PASS_ERROR, all);
  for (int32_t y = 0; y < 64; ++y) {
    for (int32_t x = 0; x < 96; ++x) {
      const size_t i = size_t(y) * 96 + size_t(x);
      left += std::pow(combined[4 * i] - fake_truth(x, y), 2);
      of_noisy += std::pow(noisy[4 * i] - fake_truth(x, y), 2);
      estimated += error[i];
    }
  }
  EXPECT_LT(left, 0.5 * of_noisy);
  EXPECT_LT(estimated, of_noisy) << "the error is that of the reconstruction";
}

// Regression: the unfinished solution was delivered.
TEST(Preview, ACancelOfTheReconstructionLeavesTheSamples) {
  GradusSettings settings = settings_of(1200, 900, 2, GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1);
  const auto render = start(settings, fake_factory());
  wait_for([&] { return render->progress().phase >= GRADUS_PHASE_RECONSTRUCTING; });
  render->cancel();
  ASSERT_TRUE(render->wait(10.0));
  ASSERT_EQ(render->outcome(nullptr), GRADUS_ERROR_CANCELLED) << "the reconstruction was too fast";
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, region_of(settings)),
            read(*render, GRADUS_PASS_NOISY_IMAGE, region_of(settings)));
}

// Running the network for each preview takes too long, but features are available.
TEST(Preview, ARenderToBeDenoisedIsReconstructedByItsFeatures) {
  GradusDeviceSettings with_denoiser{};
  with_denoiser.struct_size = sizeof(with_denoiser);
  with_denoiser.denoiser_path = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";
  GradusSettings settings = settings_of(96, 64, kForever, GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_NONE);
  settings.denoiser = GRADUS_DENOISER_OIDN;
  render::Render render(std::make_shared<scene::Device>(with_denoiser), empty_snapshot(), settings, nullptr,
                        slow_factory());
  const Region all = region_of(settings);
  read(render, GRADUS_PASS_COMBINED, all);
  wait_for([&] { return render.progress().samples_done >= 8; });
  const std::vector<float> combined = read(render, GRADUS_PASS_COMBINED, all);
  EXPECT_NE(combined, read(render, GRADUS_PASS_NOISY_IMAGE, all));
  double mean = 0.0;
  for (size_t i = 0; i < combined.size(); i += 4) mean += combined[i] / (96.0 * 64.0);
  EXPECT_NEAR(mean, 0.5, 0.1) << "the stand-in makes pictures brighter by more than 1";
}

TEST(Preview, ManyCancelsLeaveNothingBehind) {
  const GradusSettings settings =
      settings_of(64, 48, kForever, GRADUS_INTEGRATOR_AUTO, GRADUS_RECONSTRUCTION_REGULARIZED);
  for (int i = 0; i < 100; ++i) {
    const auto render = start(settings, slow_factory(std::chrono::microseconds(100)));
    std::atomic<bool> over{false};
    std::thread reader([&] {
      while (!over) read(*render, GRADUS_PASS_COMBINED, region_of(settings));
    });
    std::this_thread::sleep_for(std::chrono::microseconds(200 * i));
    render->cancel();
    EXPECT_TRUE(render->wait(10.0));
    over = true;
    reader.join();
  }
}

// A real scene: the fake integrator shows another picture at a quarter of the size.
class WatchedScene : public ::testing::Test {
 protected:
  WatchedScene() {
    build(Scenario::DiffuseArea, &scene_);
    settings = test_settings(96, 80);
    settings.max_bounces = 3;
    settings.independent_sampler = 0;
    settings.threads = 2;
    settings.samples = 256;
    settings.integrator = GRADUS_INTEGRATOR_PATH;
    settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;
    snapshot_ = scene_.context(settings).snapshot;
  }

  std::vector<float> converged(const Region& region) const {
    render::Render render(test_device(), snapshot_, settings);
    render.wait(-1.0);
    return read(render, GRADUS_PASS_COMBINED, region);
  }

  // Waits before sample number `at` of the film until it is released.
  struct Paused final : integrator::Integrator {
    std::unique_ptr<integrator::Integrator> inner;
    uint32_t at = 0;
    std::atomic<int>* holds = nullptr;
    const std::atomic<bool>* released = nullptr;
    void sample(const integrator::WorkUnit& unit, film::Film* film, film::Counters* counters,
                const std::atomic<bool>& stop) const override {
      if (unit.first_sample >= at) {
        ++*holds;
        while (!*released && !stop) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      inner->sample(unit, film, counters, stop);
    }
  };

  // Returns Combined and Noisy Image when sample `at` is about to be taken.
  std::pair<std::vector<float>, std::vector<float>> seen(GradusSettings watched, uint32_t at,
                                                         const Region& region) const {
    watched.samples = kForever;
    watched.integrator = GRADUS_INTEGRATOR_AUTO;
    watched.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
    std::atomic<int> holds{0};
    std::atomic<bool> released{false};
    const auto factory = [&](const integrator::IntegratorContext& context, uint32_t integrator) {
      auto paused = std::make_unique<Paused>();
      paused->inner = render::make_integrator(context, integrator);
      paused->at = at;
      paused->holds = &holds;
      paused->released = &released;
      return paused;
    };
    render::Render render(test_device(), snapshot_, watched, nullptr, factory);
    read(render, GRADUS_PASS_COMBINED, region);
    wait_for([&] { return holds > 0; });
    std::pair<std::vector<float>, std::vector<float>> images{read(render, GRADUS_PASS_COMBINED, region),
                                                             read(render, GRADUS_PASS_NOISY_IMAGE, region)};
    released = true;
    return images;
  }

  // Returns the error of what a screen shows: values above white are white.
  static double error(const std::vector<float>& image, const std::vector<float>& truth) {
    double sum = 0.0;
    for (size_t i = 0; i < image.size(); ++i) sum += std::pow(std::min(image[i], 1.0f) - std::min(truth[i], 1.0f), 2);
    return sum / double(image.size());
  }

  GradusSettings settings{};

 private:
  PathScene scene_;
  std::shared_ptr<const scene::Snapshot> snapshot_;
};

// Returns the best picture that a quarter of the size can represent.
std::vector<float> coarse(const std::vector<float>& image, const GradusSettings& settings, const Region& region) {
  const output::ImageSize full{settings.width, settings.height}, small{full.width / 4, full.height / 4};
  std::vector<float> means(4 * size_t{small.width} * small.height);
  for (size_t y = 0; y < full.height; ++y) {
    for (size_t x = 0; x < full.width; ++x) {
      for (size_t c = 0; c < 4; ++c)
        means[4 * (y / 4 * small.width + x / 4) + c] += image[4 * (y * full.width + x) + c] / 16.0f;
    }
  }
  const Region part = output::covering(region, full, small);
  std::vector<float> rows;
  for (int32_t y = part.y0; y < part.y1; ++y) {
    const auto row = means.begin() + 4 * (ptrdiff_t(y) * small.width + part.x0);
    rows.insert(rows.end(), row, row + 4 * part.width());
  }
  return output::enlarge(rows, 4, region, full, small);
}

TEST_F(WatchedScene, TheFirstPictureIsTheBestThatAQuarterOfTheSizeCanShow) {
  const Region all = region_of(settings);
  const std::vector<float> truth = converged(all);
  const auto [combined, noisy] = seen(settings, 1, all);
  const auto below_the_light = [&](std::vector<float> image) {
    image.resize(4 * settings.width * settings.height * 3 / 4);
    return image;
  };
  const double left = error(below_the_light(combined), coarse(truth, settings, all));
  const double of_one_sample = error(below_the_light(noisy), truth);
  std::printf("  error %.5f, of one sample %.5f\n", left, of_one_sample);
  EXPECT_LT(left, 0.25 * of_one_sample);
}

TEST_F(WatchedScene, TheFirstPictureOfARegionIsAtItsPlace) {
  const std::vector<float> truth = converged(region_of(settings));
  const uint32_t region[] = {13, 5, 73, 58};  // below the light
  std::copy(region, region + 4, settings.region);
  const Region part = region_of(settings);
  const std::vector<float> combined = seen(settings, 1, part).first;
  const double here = error(combined, coarse(truth, settings, part));
  std::printf("  error %.5f\n", here);
  for (const auto& [x, y] : {std::pair{4, 0}, {-4, 0}, {0, 4}, {0, -4}}) {
    EXPECT_LT(here,
              0.7 * error(combined, coarse(truth, settings, {part.x0 + x, part.y0 + y, part.x1 + x, part.y1 + y})))
        << x << " " << y;
  }
}

TEST_F(WatchedScene, TheReconstructionIsCloserToTheTruthThanTheSamplesSoFar) {
  const std::vector<float> truth = converged(region_of(settings));
  const auto [combined, noisy] = seen(settings, 4, region_of(settings));
  const auto [quarter, one] = seen(settings, 1, region_of(settings));
  std::printf("  error %.4f, of the samples %.4f, of the quarter %.4f\n", error(combined, truth), error(noisy, truth),
              error(quarter, truth));
  EXPECT_LT(error(combined, truth), 0.5 * error(noisy, truth));
  EXPECT_LT(error(combined, truth), error(quarter, truth));
}

}  // namespace
}  // namespace gradus::preview_test
