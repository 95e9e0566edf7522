// Where gradients pay: the model, the pilot's map, and what a render does with it.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <nlohmann/json.hpp>

#include "render/fake_integrator.h"
#include "render/options.h"
#include "render/pilot.h"

namespace gradus {
namespace {

using namespace test;

TEST(Benefit, IsTheMeanOverAllFrequencies) {
  for (const double ratio : {0.01, 0.3, 1.0, 10.0, 300.0}) {
    constexpr int kSteps = 2000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      for (int k = 0; k < kSteps; ++k) {
        const double u = std::numbers::pi * (i + 0.5) / kSteps, v = std::numbers::pi * (k + 0.5) / kSteps;
        sum += 1.0 / (1.0 + ratio * (4.0 - 2.0 * std::cos(u) - 2.0 * std::cos(v)));
      }
    }
    EXPECT_NEAR(reconstructed_variance(ratio) / (sum / kSteps / kSteps), 1.0, 1e-3) << ratio;
  }
}

TEST(Benefit, ComparesErrorWithCost) {
  PilotSums sums{100.0, 100.0, 400.0, 100.0, 1000.0, 1000.0};  // differences a quarter as noisy as pixels, for twice the rays
  EXPECT_NEAR(estimate_benefit(sums).cost, 1.6, 1e-12);
  EXPECT_NEAR(estimate_benefit(sums).error, reconstructed_variance(16.0) + 0.1, 1e-12);
  EXPECT_TRUE(estimate_benefit(sums).pays());
  sums.difference_deviation = 1600.0;
  EXPECT_FALSE(estimate_benefit(sums).pays());
  EXPECT_FALSE(estimate_benefit(PilotSums{100.0, 0.0, 400.0, 0.0, 1000.0, 100.0}).pays()) << "no noise, nothing to gain";
}

// Pixels are noisy everywhere, differences only where x is at least `noisy_from`.
struct HalfNoisy final : Integrator {
  explicit HalfNoisy(int32_t from) : noisy_from(from) {}
  int32_t noisy_from;

  void sample(const WorkUnit& unit, Frame* frame, Counters* counters, const std::atomic<bool>& /*stop*/) const override {
    for (int32_t y = unit.tile.y0; y < unit.tile.y1; ++y) {
      for (int32_t x = unit.tile.x0; x < unit.tile.x1; ++x) {
        const bool is_on = unit.gradient_map == nullptr || (*unit.gradient_map)[frame->index(x, y)] != 0;
        for (uint32_t s = unit.first_sample; s < unit.first_sample + unit.count; ++s) {
          sample_pixel(x, y, s, frame->gradients && is_on, frame, counters);
        }
      }
    }
  }

  void sample_pixel(int32_t x, int32_t y, uint32_t s, bool has_gradients, Frame* frame, Counters* counters) const {
    const size_t i = frame->index(x, y);
    const int half = int(s % 2);
    frame->components[0].primal[half][i] += Radiance(random_value(x, y, s));
    ++frame->count[half][i];
    counters->rays_primary += 4;
    if (!has_gradients) return;
    counters->rays_shift += 4;
    for (int k = 0; k < kOffsets; ++k) {
      if (!frame->region.contains(x + kOffsetX[k], y + kOffsetY[k])) continue;
      frame->components[0].gradient[half][k][i] += Radiance(x >= noisy_from ? 5.0f * random_value(x, y, s + 77 * uint32_t(k)) : 0.1f);
      frame->pair_count[half][k][i] += 1.0f;
    }
  }
};

GradientMap pilot(const GradusSettings& settings, const Region& region, int32_t noisy_from) {
  const std::atomic<bool> stop{false};
  return run_pilot(HalfNoisy(noisy_from), pilot_settings(settings), region, 3, stop);
}

TEST(Pilot, LeavesGradientsWhereTheyPay) {
  const GradientMap map = pilot(small_settings(256, 96, 4), {0, 0, 256, 96}, 128);
  EXPECT_EQ(map.pixels[10 * 256 + 20], 1);
  EXPECT_EQ(map.pixels[10 * 256 + 200], 0);
  EXPECT_NEAR(map.share, 0.5, 0.15);
  EXPECT_TRUE(pilot(small_settings(256, 96, 4), {0, 0, 256, 96}, 1000).all());
  EXPECT_TRUE(pilot(small_settings(256, 96, 4), {0, 0, 256, 96}, 0).none());
}

// Planes of a border, of another seed, of 16 and then 48 samples must fit together (contract 2.1).
TEST(Pilot, MapDependsOnThePictureAlone) {
  GradusSettings s = small_settings(300, 200, 4);
  const GradientMap full = pilot(s, {0, 0, 300, 200}, 130);
  s.samples = 64;
  s.seed = 5;
  s.frame = 7;
  s.first_sample = 16;
  const Region part{77, 45, 251, 133};
  const GradientMap map = pilot(s, part, 130);
  for (int32_t y = part.y0; y < part.y1; ++y) {
    for (int32_t x = part.x0; x < part.x1; ++x) {
      ASSERT_EQ(map.pixels[size_t(y - part.y0) * size_t(part.width()) + size_t(x - part.x0)], full.pixels[size_t(y) * 300 + size_t(x)])
          << x << ", " << y;
    }
  }
}

// A user could choose its seed, and had the samples that chose the map in the picture: L2 was biased.
TEST(Pilot, ItsSeedIsNoUsers) { EXPECT_GT(pilot_settings(small_settings(8, 8, 1)).seed, find_option("seed")->maximum); }

nlohmann::json stats_of(int32_t noisy_from, uint32_t integrator, std::shared_ptr<const Frame>* frame) {
  GradusSettings s = small_settings(256, 96, 4);
  s.integrator = integrator;
  const auto factory = [&](const IntegratorContext&, uint32_t) { return std::make_unique<HalfNoisy>(noisy_from); };
  const auto render = start(s, factory);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_OK) << text;
  *frame = render->frame();
  return nlohmann::json::parse(render->stats_json());
}

TEST(Pilot, AutoDecidesAndSaysWhy) {
  std::shared_ptr<const Frame> frame;
  const nlohmann::json some = stats_of(128, GRADUS_INTEGRATOR_AUTO, &frame);
  EXPECT_EQ(some["integrator"], "gradient");
  EXPECT_TRUE(frame->gradients);
  EXPECT_GT(frame->pair_count[0][kRight][10], 0.0f);
  EXPECT_EQ(frame->pair_count[0][kRight][200], 0.0f);
  const nlohmann::json none = stats_of(0, GRADUS_INTEGRATOR_AUTO, &frame);
  EXPECT_EQ(none["integrator"], "path");
  EXPECT_EQ(none["reconstruction"], "none");
  EXPECT_FALSE(frame->gradients);
  EXPECT_NE(none["plan"]["skipped"]["gradients"].get<std::string>().find("pilot"), std::string::npos);
  // What the user says is obeyed.
  EXPECT_EQ(stats_of(0, GRADUS_INTEGRATOR_GRADIENT, &frame)["integrator"], "gradient");
  const GradientImages images = read_images(*frame, 0, false);
  for (const auto* differences : {&images.dx, &images.dy}) {
    EXPECT_TRUE(std::all_of(differences->begin(), differences->end(), [](float v) { return is_finite(v); }));
  }
}

}  // namespace
}  // namespace gradus
