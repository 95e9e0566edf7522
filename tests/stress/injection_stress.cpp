// B6 at scale: values that are not finite and fireflies are injected into samples.
#include <cmath>
#include <limits>

#include "film/finite_check.h"
#include "render/fake_integrator.h"
#include "stress/stress.h"
#include "support/developed.h"

namespace gradus::stress::injection_stress {
namespace {

using test::FakeIntegrator;

// The fake scene (a smooth picture with exact differences), into which further samples are injected.
class Injecting : public integrator::Integrator {
 public:
  using Value = std::function<Radiance(int32_t x, int32_t y, uint32_t sample)>;
  Injecting(const integrator::IntegratorContext& context, Value value)
      : fake_(context, true), value_(std::move(value)) {}

  void sample(const integrator::WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& stop) const override {
    fake_.sample(unit, film, counters, stop);
    for (int32_t y = unit.tile.y0; y < unit.tile.y1; ++y) {
      for (int32_t x = unit.tile.x0; x < unit.tile.x1; ++x) {
        for (uint32_t s = unit.first_sample; s < unit.first_sample + unit.count; ++s) inject(x, y, s, film, counters);
      }
    }
  }

 private:
  // Injects a sample as the gradient integrator would: a firefly of a pixel whose shifts fail appears in all of its
  // differences.
  void inject(int32_t x, int32_t y, uint32_t s, film::Film* film, film::Counters* counters) const {
    const Radiance value = value_(x, y, s);
    if (value == Radiance(0.0f)) return;
    const size_t i = film->index(x, y);
    film::add_radiance(value, &film->components[0].primal[s % 2][i], counters);
    for (int k = 0; k < film::kOffsets; ++k) {
      if (film->region.contains(x + film::kOffsetX[k], y + film::kOffsetY[k])) {
        film::add_gradient(-0.5f * value, &film->components[0].gradient[s % 2][k][i], counters);
      }
    }
  }
  FakeIntegrator fake_;
  Value value_;
};

struct Images {
  std::vector<float> noisy, l2, l1;
  film::Counters counters;
};

Images rendered(uint32_t size, uint32_t samples, const Injecting::Value& value) {
  GradusSettings settings = test::small_settings(size, size, samples);
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;  // with AUTO, a pilot would take samples that are discarded
  render::Render render(nullptr, test::empty_snapshot(), settings, nullptr,
                        [&](const integrator::IntegratorContext& context, uint32_t) {
                          return std::make_unique<Injecting>(context, value);
                        });
  EXPECT_TRUE(render.wait(-1.0));
  const auto film = render.film();
  const auto image = [&](uint32_t how) { return test::reconstructed(film, how, film->region); };
  Images images{image(GRADUS_RECONSTRUCTION_NONE), image(GRADUS_RECONSTRUCTION_L2), image(GRADUS_RECONSTRUCTION_L1),
                film->counters};
  for (const auto* i : {&images.noisy, &images.l2, &images.l1}) expect_finite(*i, "image");
  return images;
}

const Injecting::Value kNothing = [](int32_t, int32_t, uint32_t) { return Radiance(0.0f); };

// A million fireflies of up to 1e6 times the picture, on its left half. L2 keeps their sum; its response falls by a
// factor of 0.67 per pixel, so that it is 1e-11 after 64 pixels, on the right half. L1 takes its scale from the median
// of the picture, which fireflies have moved: it may remove less noise there than without them, but must not add error.
TEST(Fireflies, AMillionOfThemDoNotSpread) {
  const uint32_t size = full_run() ? 1024 : 256, samples = full_run() ? 4 : 8;
  const uint64_t wanted = full_run() ? 1000000 : 100000;
  const double share = double(wanted) / (double(size) * size / 2 * samples);
  std::atomic<uint64_t> injected{0};
  const Images images = rendered(size, samples, [&](int32_t x, int32_t y, uint32_t s) {
    if (x >= int32_t(size / 2) || test::random_value(x, y, s + 2000) >= share) return Radiance(0.0f);
    ++injected;
    const float value = std::pow(10.0f, 6.0f * test::random_value(x, y, s + 1000));
    return Radiance(value, value, value, 0.0f);
  });
  EXPECT_NEAR(double(injected), double(wanted), 0.05 * double(wanted));
  enter_row(std::to_string(injected) + " fireflies", images.counters);
  EXPECT_NEAR(mean(images.l2) / mean(images.noisy), 1.0, 1e-5);
  const Images calm = rendered(size, samples, kNothing);
  double l2 = 0.0, l1 = 0.0, noisy = 0.0;
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = size / 2 + 64; x < size; ++x) {
      const size_t i = 4 * (size_t(y) * size + x);
      const float truth = test::fake_truth(int32_t(x), int32_t(y));
      l2 = std::max(l2, double(std::fabs(images.l2[i] - calm.l2[i])));
      l1 += std::pow(images.l1[i] - truth, 2);
      noisy += std::pow(images.noisy[i] - truth, 2);
    }
  }
  // 1e-7 of the largest firefly: the rounding error of the transforms.
  EXPECT_LT(l2, 0.1);
  EXPECT_LT(l1, 1.1 * noisy);
}

// Few fireflies stand out from the picture: L1 leaves them out.
TEST(Fireflies, ScatteredOnesDoNotSpread) {
  const auto scattered = [](int32_t x, int32_t y, uint32_t s) {
    return s == 1 && x % 37 == 5 && y % 37 == 7 ? Radiance(1e6f, 1e6f, 1e6f, 0.0f) : Radiance(0.0f);
  };
  const Images images = rendered(256, 16, scattered), calm = rendered(256, 16, kNothing);
  const auto share_off = [](const std::vector<float>& a, const std::vector<float>& b) {
    size_t off = 0;
    for (size_t i = 0; i < a.size(); ++i) off += std::fabs(a[i] - b[i]) > 0.1f ? 1 : 0;
    return double(off) / double(a.size());
  };
  EXPECT_LE(share_off(images.l1, calm.l1), 0.01);
}

// Every tenth sample is not finite; these are counted, and the other samples make the pixel's value.
TEST(NonFinite, SamplesAreDroppedAndCounted) {
  constexpr uint32_t size = 64, samples = 16;
  std::atomic<uint64_t> injected{0};
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity};
  const Images images = rendered(size, samples, [&](int32_t x, int32_t y, uint32_t s) {
    if (test::hash(uint32_t(x + 64 * y) * samples + s) % 10 != 0) return Radiance(0.0f);
    ++injected;
    return Radiance(1.0f, bad[s % 3], 1.0f, 0.0f);
  });
  const Images calm = rendered(size, samples, kNothing);
  enter_row(std::to_string(injected) + " samples that are not finite", images.counters);
  EXPECT_GT(injected, 6000u);
  EXPECT_EQ(images.counters.nonfinite_radiance, injected);
  EXPECT_EQ(images.noisy, calm.noisy);
  EXPECT_EQ(images.l2, calm.l2);
  EXPECT_EQ(images.l1, calm.l1);
}

// A material whose emission is NaN is black. Regression: all paths that met it were dropped, two thirds of the picture.
TEST(NonFinite, AMaterialThatEmitsNaNIsBlack) {
  const auto emitting = [](const std::string& name, float value) {
    PathScene scene;
    build_box(&scene);
    Surface surface = test::matte(Rgb(0.2f));
    surface.emission = Rgb(value);
    scene.quad(Vec3(-0.2f, -0.2f, 0.9f), Vec3(0.4f, 0, 0), Vec3(0, 0.4f, 0), scene.material(surface));
    return render(name, &scene, {});
  };
  const Outcome black = emitting("material without emission", 0.0f);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
    const Outcome broken = emitting("material that emits " + text_of(value), value);
    EXPECT_NEAR(mean(broken.noisy), mean(black.noisy), 0.05 * mean(black.noisy));
  }
}

// Each sample is finite, but their sum is not. Regression: the picture had infinite pixels.
TEST(NonFinite, SumsDoNotOverflow) {
  const GradusSettings settings = small_picture();
  const uint64_t all = uint64_t(settings.width) * settings.height * settings.samples;
  PathScene scene;
  build_box(&scene);
  Surface surface;
  surface.emission = Rgb(3e38f);
  scene.quad(Vec3(-0.2f, -0.2f, 0.9f), Vec3(0.4f, 0, 0), Vec3(0, 0.4f, 0), scene.material(surface));
  // Nearly every path meets the emitter and exceeds what may be summed: radiance, four gradients and a few passes.
  render("material that emits 3e38", &scene, Bounds().dropping(10 * all).without_double());
}

}  // namespace
}  // namespace gradus::stress::injection_stress
