// The benefit of gradients: its model, the pilot's map, and how a render uses the map.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <nlohmann/json.hpp>

#include "reconstruct/poisson/solver.h"
#include "render/fake_integrator.h"
#include "render/l2_noise.h"
#include "render/pilot.h"
#include "schema/options.h"

namespace gradus::pilot_test {
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
    EXPECT_NEAR(render::reconstructed_variance(ratio) / (sum / kSteps / kSteps), 1.0, 1e-3) << ratio;
  }
}

render::PilotSums quiet_sums() {  // differences have a quarter of the noise of pixels, at twice the rays
  render::PilotSums sums;
  sums.pixels = sums.brightness = sums.pixel_deviation = sums.pixel_root = 100.0;
  sums.differences = 400.0;
  sums.difference_deviation = sums.plain_rays = 100.0;
  sums.shift_rays = sums.shift_shadow_rays = 50.0;
  sums.l2_roots.fill(50.0);
  return sums;
}

TEST(Benefit, ComparesErrorWithCost) {
  render::PilotSums sums = quiet_sums();
  EXPECT_NEAR(render::estimate_benefit(sums).cost, 1.885, 1e-12);
  EXPECT_NEAR(render::estimate_benefit(sums).error, render::reconstructed_variance(16.0) + 0.1, 1e-12);
  EXPECT_TRUE(render::estimate_benefit(sums).pays());
  sums.difference_deviation = 1600.0;
  EXPECT_FALSE(render::estimate_benefit(sums).pays());
  sums.pixel_deviation = 0.0;
  EXPECT_FALSE(render::estimate_benefit(sums).pays()) << "no noise, nothing to gain";
}

// Regression: in foliage smaller than pixels all shifts fail, and a difference is then that of the pixels' own samples
// with their noise. The pilot treated this noise as independent and expected half of the error, but the error was 2.5
// times that of path tracing in the same time.
TEST(Benefit, DifferencesOfThePixelsOwnSamplesHaveNoBenefit) {
  render::PilotSums sums = quiet_sums();
  sums.difference_deviation = 400.0 * std::sqrt(2.0);
  sums.l2_roots = {150.0, 120.0, 98.0};
  EXPECT_GT(render::estimate_benefit(sums).error, 0.9);
  EXPECT_FALSE(render::estimate_benefit(sums).pays());
  sums.l2_roots = {150.0, 60.0, 98.0};  // at its best weight, L2 gains
  EXPECT_TRUE(render::estimate_benefit(sums).pays());
}

// Regression: unpaired paths appear in the differences as in the pixel, and L2 reproduces them. The pilot judged
// differences by their deviations alone, and expected a third of the noise behind a glass teapot, where all of it
// remained.
TEST(L2Noise, KeepsUnpairedPaths) {
  const render::L2Noise l2(0.4);
  const Radiance c(3.0f, 1.0f, 2.0f, 0.0f);
  EXPECT_NEAR(l2.of(c, {-c, -c, -c, -c}), (9.0 + 1.0 + 4.0) / 3.0, 1e-9);
  EXPECT_NEAR(l2.of(Radiance(0.0f), {}), 0.0, 1e-12);
}

// The sum of squares over a picture that one sample changes.
TEST(L2Noise, IsTheResponseOfTheSolverToASample) {
  constexpr int kSize = 64, kAt = 32;
  film::GradientImages images;
  images.width = images.height = kSize;
  images.channels = 1;
  for (auto* plane : {&images.primal, &images.dx, &images.dy}) plane->assign(size_t(kSize) * kSize, 0.0f);
  const auto at = [&](int x, int y) { return size_t(y) * kSize + size_t(x); };
  const float d[film::kOffsets] = {0.7f, -0.2f, -1.3f, 0.4f};
  images.primal[at(kAt, kAt)] = 2.0f;
  images.dx[at(kAt, kAt)] = d[film::kRight];
  images.dy[at(kAt, kAt)] = d[film::kUp];
  images.dx[at(kAt - 1, kAt)] = -d[film::kLeft];
  images.dy[at(kAt, kAt - 1)] = -d[film::kDown];
  const std::vector<float> x = reconstruct::reconstruct(images, GRADUS_RECONSTRUCTION_L2, 0.4f, {}, nullptr);
  double sum = 0.0;
  for (const float v : x) sum += double(v) * v;
  std::array<Radiance, film::kOffsets> differences;
  for (int k = 0; k < film::kOffsets; ++k) differences[k] = Radiance(d[k]);
  EXPECT_NEAR(render::L2Noise(0.4).of(Radiance(2.0f), differences) / sum, 1.0, 1e-3);
}

// One part is dark for gradients and has all the noise: the gain elsewhere is not worth the time.
TEST(Benefit, TheChoiceConsidersTheWholePicture) {
  const auto part = [](double noise, double error, double cost) {
    render::Benefit b;
    b.noisy = true;
    b.noise = noise;
    b.error = error;
    b.cost = cost;
    b.rays = 5.0;
    return b;
  };
  const std::vector<double> pixels(3, 100.0);
  using Chosen = std::vector<bool>;
  EXPECT_EQ(render::choose_blocks({part(1, 0.1, 2), part(1, 0.2, 2), part(1, 0.1, 2)}, pixels),
            (Chosen{true, true, true}));
  EXPECT_EQ(render::choose_blocks({part(1, 0.1, 2), part(100, 0.9, 2), part(1, 0.1, 2)}, pixels),
            (Chosen{false, false, false}));
  EXPECT_EQ(render::choose_blocks({part(1, 0.1, 2), part(100, 0.1, 2), part(1, 0.9, 2)}, pixels),
            (Chosen{false, true, false}));
  EXPECT_EQ(render::choose_blocks({part(1, 0.1, 2), part(1, 0.2, 2), part(1, 0.6, 2)}, pixels),
            (Chosen{true, true, true}))
      << "hardly better";
  EXPECT_EQ(render::choose_blocks({part(0, 1, 2), part(0, 1, 1), part(0, 1, 3)}, pixels), (Chosen{false, false, false}))
      << "no noise";
}

// Pixels are noisy everywhere, differences only where x is at least `noisy_from`.
struct HalfNoisy final : integrator::Integrator {
  explicit HalfNoisy(int32_t from) : noisy_from(from) {}
  int32_t noisy_from;

  void sample(const integrator::WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& /*stop*/) const override {
    for (int32_t y = unit.tile.y0; y < unit.tile.y1; ++y) {
      for (int32_t x = unit.tile.x0; x < unit.tile.x1; ++x) {
        if (unit.pixel_map != nullptr && (*unit.pixel_map)[film->index(x, y)] == 0) continue;
        const bool is_on = unit.gradient_map == nullptr || (*unit.gradient_map)[film->index(x, y)] != 0;
        for (uint32_t s = unit.first_sample; s < unit.first_sample + unit.count; ++s) {
          sample_pixel(x, y, s, film->gradients && is_on, film, counters);
        }
      }
    }
  }

  void sample_pixel(int32_t x, int32_t y, uint32_t s, bool has_gradients, film::Film* film,
                    film::Counters* counters) const {
    const size_t i = film->index(x, y);
    const int half = int(s % 2);
    film->components[0].primal[half][i] += Radiance(random_value(x, y, s));
    ++film->count[half][i];
    counters->rays_primary += 4;
    if (!has_gradients) return;
    counters->rays_shift += 4;
    for (int k = 0; k < film::kOffsets; ++k) {
      if (!film->region.contains(x + film::kOffsetX[k], y + film::kOffsetY[k])) continue;
      film->components[0].gradient[half][k][i] +=
          Radiance(x >= noisy_from ? 5.0f * random_value(x, y, s + 77 * uint32_t(k)) : 0.1f);
      film->pair_count[half][k][i] += 1.0f;
    }
  }
};

render::GradientMap pilot(const GradusSettings& settings, const Region& region, int32_t noisy_from,
                          uint32_t reconstruction = GRADUS_RECONSTRUCTION_L1) {
  const std::atomic<bool> stop{false};
  return render::run_pilot(HalfNoisy(noisy_from), render::pilot_settings(settings), reconstruction, region, 3, stop);
}

TEST(Pilot, KeepsGradientsWhereTheyPay) {
  const render::GradientMap map = pilot(small_settings(256, 96, 4), {0, 0, 256, 96}, 128);
  EXPECT_EQ(map.pixels[10 * 256 + 20], 1);
  EXPECT_EQ(map.pixels[10 * 256 + 200], 0);
  EXPECT_NEAR(map.share, 0.5, 0.15);
  EXPECT_TRUE(pilot(small_settings(256, 96, 4), {0, 0, 256, 96}, 1000).all());
  EXPECT_TRUE(pilot(small_settings(256, 96, 4), {0, 0, 256, 96}, 0).none());
}

// The films of a border, of another seed, and of 16 and then 48 samples must have the same planes.
TEST(Pilot, MapDependsOnThePictureAlone) {
  GradusSettings s = small_settings(300, 200, 4);
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L1, GRADUS_RECONSTRUCTION_L2}) {
    s.samples = 4;
    s.seed = s.frame = s.first_sample = 0;
    const render::GradientMap full = pilot(s, {0, 0, 300, 200}, 230, reconstruction);
    EXPECT_GT(full.share, 0.0);
    EXPECT_LT(full.share, 1.0);
    s.samples = 64;
    s.seed = 5;
    s.frame = 7;
    s.first_sample = 16;
    const Region part{77, 45, 251, 133};
    const render::GradientMap map = pilot(s, part, 230, reconstruction);
    for (int32_t y = part.y0; y < part.y1; ++y) {
      for (int32_t x = part.x0; x < part.x1; ++x) {
        ASSERT_EQ(map.pixels[size_t(y - part.y0) * size_t(part.width()) + size_t(x - part.x0)],
                  full.pixels[size_t(y) * 300 + size_t(x)])
            << x << ", " << y;
      }
    }
  }
}

// Regression: a user could choose the pilot's seed, so that the samples that chose the map were in the picture: L2 was
// biased.
TEST(Pilot, ItsSeedIsNoUsersSeed) {
  EXPECT_GT(render::pilot_settings(small_settings(8, 8, 1)).seed, schema::find_option("seed")->maximum);
}

nlohmann::json stats_of(int32_t noisy_from, uint32_t integrator, std::shared_ptr<const film::Film>* film) {
  GradusSettings s = small_settings(256, 96, 4);
  s.integrator = integrator;
  s.reconstruction = GRADUS_RECONSTRUCTION_L1;
  const auto factory = [&](const integrator::IntegratorContext&, uint32_t) {
    return std::make_unique<HalfNoisy>(noisy_from);
  };
  const auto render = start(s, factory);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_OK) << text;
  *film = render->film();
  return nlohmann::json::parse(render->stats_json());
}

// Regression: a cancelled pilot had no reason to leave gradients out, so that the film to resume did not match: an
// error of a wrong argument.
TEST(Pilot, ACancelDuringItIsACancel) {
  GradusSettings s = small_settings(64, 48, 4);
  s.integrator = GRADUS_INTEGRATOR_AUTO;
  s.reconstruction = GRADUS_RECONSTRUCTION_L1;
  const auto noisy = [](const integrator::IntegratorContext&, uint32_t) { return std::make_unique<HalfNoisy>(64); };
  const auto first = start(s, noisy);
  first->wait(-1.0);
  ASSERT_TRUE(first->film()->gradients);
  std::atomic<bool> is_cancelled{false};
  const auto waits = [&](const integrator::IntegratorContext& context, uint32_t integrator) {
    while (!is_cancelled) std::this_thread::yield();
    return noisy(context, integrator);
  };
  s.samples = 8;
  const auto second = start(s, waits, first->film());
  second->cancel();
  is_cancelled = true;
  second->wait(-1.0);
  std::string text;
  EXPECT_EQ(second->outcome(&text), GRADUS_ERROR_CANCELLED) << text;
  EXPECT_EQ(read(*second, GRADUS_PASS_COMBINED, {0, 0, 64, 48})[0], 0.0f);
}

TEST(Pilot, AutoDecidesAndReportsWhy) {
  std::shared_ptr<const film::Film> film;
  const nlohmann::json some = stats_of(128, GRADUS_INTEGRATOR_AUTO, &film);
  EXPECT_EQ(some["integrator"], "gradient");
  EXPECT_TRUE(film->gradients);
  EXPECT_GT(film->pair_count[0][film::kRight][10], 0.0f);
  EXPECT_EQ(film->pair_count[0][film::kRight][200], 0.0f);
  const nlohmann::json none = stats_of(0, GRADUS_INTEGRATOR_AUTO, &film);
  EXPECT_EQ(none["integrator"], "path");
  EXPECT_EQ(none["reconstruction"], "none");
  EXPECT_FALSE(film->gradients);
  EXPECT_NE(none["plan"]["skipped"]["gradients"].get<std::string>().find("pilot"), std::string::npos);
  // An explicit choice of the user is respected.
  EXPECT_EQ(stats_of(0, GRADUS_INTEGRATOR_GRADIENT, &film)["integrator"], "gradient");
  const film::GradientImages images = film::read_images(*film, 0);
  for (const auto* differences : {&images.dx, &images.dy}) {
    EXPECT_TRUE(std::all_of(differences->begin(), differences->end(), [](float v) { return is_finite(v); }));
  }
}

}  // namespace
}  // namespace gradus::pilot_test
