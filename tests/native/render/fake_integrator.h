// An integrator whose samples are a pure function of pixel and sample number, so that tests of the loop need no scene.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "base/error.h"
#include "film/finite_check.h"
#include "render/render.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::test {

inline uint32_t hash(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

// Returns a value in [0, 1).
inline float random_value(int32_t x, int32_t y, uint32_t sample) {
  return float(hash(hash(hash(uint32_t(x)) + uint32_t(y)) + sample) >> 8) / float(1 << 24);
}

// Returns the expectation of a pixel of the fake scene.
inline float fake_truth(int32_t x, int32_t y) {
  return 0.5f + 0.3f * std::sin(0.2f * float(x)) * std::cos(0.15f * float(y));
}

struct FakeIntegrator final : integrator::Integrator {
  explicit FakeIntegrator(const integrator::IntegratorContext& context, bool with_gradients)
      : settings(context.settings), gradients(with_gradients) {}

  // Called before each tile; may wait or throw.
  std::function<void(const integrator::WorkUnit&)> before = [](const integrator::WorkUnit&) {};
  GradusSettings settings;
  bool gradients;
  float noise = 1.0f;
  float light = 1.0f;               // factor of all radiance
  int32_t quiet_until = 0;          // left of this column, the noise is a tenth
  int32_t rays_below = 0;           // below this row, a sample costs five rays instead of one
  uint32_t feature_seed = 0x10000;  // of the noise of features; 0: the image's noise, which the features explain then
  int32_t pairs_until = INT32_MAX;  // right of this column there are no gradients

  uint32_t count_at(const integrator::WorkUnit& unit, const film::Film& film, int32_t x, int32_t y) const {
    return unit.count_map ? (*unit.count_map)[film.index(x, y)] : unit.count;
  }

  void sample(const integrator::WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& stop) const override {
    before(unit);
    for (int32_t y = unit.tile.y0; y < unit.tile.y1; ++y) {
      for (int32_t x = unit.tile.x0; x < unit.tile.x1; ++x) sample_pixel(unit, x, y, film, counters, stop);
    }
  }

  void sample_pixel(const integrator::WorkUnit& unit, int32_t x, int32_t y, film::Film* film, film::Counters* counters,
                    const std::atomic<bool>& stop) const {
    const size_t i = film->index(x, y);
    const uint32_t count = count_at(unit, *film, x, y);
    const uint32_t first = unit.first_map ? (*unit.first_map)[i] : unit.first_sample;
    for (uint32_t s = first; s < first + count; ++s) {
      if (stop.load()) return;
      const int half = int(s % 2);
      const float value = value_of(x, y, s);
      film->components[0].primal[half][i] +=
          Radiance(light * value, 0.5f * light * value, 2.0f * light * value, film->color_channels == 4 ? 0.75f : 0.0f);
      ++film->count[half][i];
      counters->rays_primary += y < rays_below ? 5 : 1;
      for (film::Channel& plane : film->channels)
        add_pass(&plane, i, plane.info.in_halves ? value_of(x, y, s + feature_seed) : value, s);
      if (gradients && x < pairs_until) add_gradients(unit, x, y, half, film);
    }
  }

  float value_of(int32_t x, int32_t y, uint32_t sample) const {
    return fake_truth(x, y) + (x < quiet_until ? 0.1f : 1.0f) * noise * (random_value(x, y, sample) - 0.5f);
  }

  static void add_pass(film::Channel* plane, size_t i, float value, uint32_t sample) {
    if (plane->info.type == film::ValueType::kIdAndWeight) {
      film::Counters counters;
      const uint32_t values = plane->info.values_per_pixel;
      return film::add_pair(float(sample % 3 + 1), value, values / 2,
                            plane->of_half(int(sample % 2)).data() + i * values, &counters);
    }
    for (uint32_t c = 0; c < plane->info.values_per_pixel; ++c) {
      float& v = plane->of_half(int(sample % 2))[i * plane->info.values_per_pixel + c];
      v = plane->keeps_first_sample() ? (sample == 0 ? value : v) : v + value;
    }
    if (plane->has_weight()) plane->weight[i] += 1.0f;
  }

  // Adds the exact differences of the truth, half for each direction.
  void add_gradients(const integrator::WorkUnit& unit, int32_t x, int32_t y, int half, film::Film* film) const {
    const size_t i = film->index(x, y);
    for (int o = 0; o < film::kOffsets; ++o) {
      const int32_t nx = x + film::kOffsetX[o], ny = y + film::kOffsetY[o];
      if (!film->region.contains(nx, ny) || count_at(unit, *film, nx, ny) == 0) continue;
      const float d = 0.5f * (fake_truth(nx, ny) - fake_truth(x, y));
      film->components[0].gradient[half][o][i] += Radiance(d, 0.5f * d, 2.0f * d, 0.0f);
      film->pair_count[half][o][i] += 1.0f;
    }
  }
};

using Configure = std::function<void(FakeIntegrator*)>;

inline render::IntegratorFactory fake_factory(Configure configure = [](FakeIntegrator*) {}) {
  return [configure](const integrator::IntegratorContext& context, uint32_t integrator) {
    auto fake = std::make_unique<FakeIntegrator>(context, integrator == GRADUS_INTEGRATOR_GRADIENT);
    configure(fake.get());
    return fake;
  };
}

inline std::shared_ptr<const scene::Snapshot> empty_snapshot(uint64_t content_key = 42) {
  auto snapshot = std::make_shared<scene::Snapshot>();
  snapshot->has_camera = true;
  snapshot->camera.clip_end = 100.0f;
  snapshot->content_key = content_key;
  return snapshot;
}

inline GradusSettings small_settings(uint32_t width, uint32_t height, uint32_t samples) {
  GradusSettings s = schema::default_settings();
  s.width = width;
  s.height = height;
  s.samples = samples;
  s.denoiser = GRADUS_DENOISER_NONE;
  s.use_guiding = 0;  // it learns from paths, and the snapshot has nothing to trace them in
  s.threads = 2;
  s.noise_threshold = 0.0f;
  s.integrator = GRADUS_INTEGRATOR_GRADIENT;
  return s;
}

inline std::unique_ptr<render::Render> start(const GradusSettings& settings,
                                             const render::IntegratorFactory& factory = fake_factory(),
                                             std::shared_ptr<const film::Film> resumed = nullptr) {
  return std::make_unique<render::Render>(nullptr, empty_snapshot(), settings, std::move(resumed), factory);
}

inline std::unique_ptr<render::Render> start_and_wait(const GradusSettings& settings,
                                                      std::shared_ptr<const film::Film> resumed = nullptr) {
  auto render = start(settings, fake_factory(), std::move(resumed));
  render->wait(-1.0);
  return render;
}

inline std::shared_ptr<const film::Film> rendered(const GradusSettings& settings,
                                                  std::shared_ptr<const film::Film> resumed = nullptr) {
  return start_and_wait(settings, std::move(resumed))->film();
}

inline std::vector<float> read(const render::Render& render, uint32_t pass, const Region& region) {
  std::vector<float> pixels(size_t(region.area()) * schema::pass_info(pass).channels);
  render.read_pass(pass, pixels.data(), pixels.size());
  return pixels;
}

inline bool same_samples(const film::Film& a, const film::Film& b) {
  for (int half = 0; half < film::kHalves; ++half) {
    if (a.components[0].primal[half] != b.components[0].primal[half] || a.count[half] != b.count[half]) return false;
    if (a.components[0].gradient[half] != b.components[0].gradient[half] || a.pair_count[half] != b.pair_count[half])
      return false;
  }
  const auto same = [](const film::Channel& p, const film::Channel& q) {
    return p.info == q.info && p.values == q.values && p.weight == q.weight && p.paths == q.paths;
  };
  return std::ranges::equal(a.channels, b.channels, same);
}

}  // namespace gradus::test
