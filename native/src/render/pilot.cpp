#include "render/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/clock.h"
#include "base/fpu.h"
#include "film/pixel_blocks.h"
#include "path/sampler.h"
#include "reconstruct/chosen_alpha.h"
#include "render/l2_noise.h"
#include "render/pausable_loop.h"

namespace gradus::render {
namespace {

// Each block of kBlockSide² pixels has kColumns·kRows test pixels with kPilotSamples samples, 1/16 of a sample per
// pixel. It is judged by its own test pixels and those of the blocks around. Test pixels are spread out, because
// neighbouring pixels see nearly the same.
constexpr int kBlockSide = 32;
constexpr int kColumns = 8, kRows = 4;
constexpr uint32_t kPilotSamples = 2;
// The seed of the pilot. Seeds of users are below 2³¹; with one of them the pilot's samples could be those of frame 0
// that are kept.
constexpr uint32_t kSeed = 0xf0696c6fu;

// Returns the region enlarged by `by` pixels on each side, within `limit`.
Region grown(const Region& r, int by, const Region& limit) {
  return film::intersection({r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by}, limit);
}

// Returns the indices of the test pixels of a block: a random pixel in each stratum, so that no regular pattern of the
// image aligns with all of them. Blocks at the border may have fewer pixels per side than there are strata.
std::vector<size_t> pixels_of(const Region& block, const film::Film& film, uint32_t seed) {
  std::vector<size_t> pixels;
  const int columns = std::min(kColumns, block.width()), rows = std::min(kRows, block.height());
  const auto place = [](int32_t begin, int32_t size, int i, int n, uint32_t random) {
    const int32_t first = begin + size * i / n, end = begin + size * (i + 1) / n;
    return first + int32_t(random % uint32_t(end - first));
  };
  uint32_t h = path::combine(path::combine(seed, uint32_t(block.x0)), uint32_t(block.y0));
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      h = path::combine(h, uint32_t(j * kColumns + i));
      const int32_t x = place(block.x0, block.width(), i, columns, h & 0xffffu);
      const int32_t y = place(block.y0, block.height(), j, rows, h >> 16);
      pixels.push_back(film.index(x, y));
    }
  }
  return pixels;
}

double deviation(const Radiance& d) { return std::sqrt(mean_product(d, d)); }
double gray(const Radiance& c) { return (double(c.x) + c.y + c.z) / 3.0; }

using L2Noises = std::array<L2Noise, kPilotAlphas>;

// Returns the noise models of L2: at the weight α of the render if L2 will run; else at three weights between which the
// best one was on all scenes that were examined.
L2Noises l2_noises(const GradusSettings& settings, uint32_t reconstruction) {
  if (reconstruction != GRADUS_RECONSTRUCTION_L2) return {L2Noise(0.2), L2Noise(0.4), L2Noise(0.8)};
  const L2Noise own(reconstruct::chosen_alpha(reconstruction, settings.reconstruction_alpha));
  return {own, own, own};
}

// Adds a test pixel, which has one sample in each half-buffer. In the render, a difference of neighbours has samples
// from both of its pixels, with the same distribution; here only from one, hence the factor √2.
void add_pixel(const film::Film& film, size_t pixel, const L2Noises& l2, PilotSums* sums) {
  const film::ComponentPlanes& planes = film.components[0];
  const Radiance spread = planes.primal[0][pixel] - planes.primal[1][pixel];
  std::array<Radiance, film::kOffsets> spreads;
  for (int k = 0; k < film::kOffsets; ++k) {
    const float pair = film.pair_count[0][k][pixel];
    spreads[k] = pair > 0.0f ? (planes.gradient[0][k][pixel] - planes.gradient[1][k][pixel]) / pair : Radiance(0.0f);
    if (!(pair > 0.0f)) continue;
    ++sums->differences;
    sums->difference_deviation += std::numbers::sqrt2 * deviation(spreads[k]);
  }
  ++sums->pixels;
  sums->brightness += 0.5 * gray(planes.primal[0][pixel] + planes.primal[1][pixel]);
  sums->pixel_deviation += deviation(spread);
  sums->pixel_root += std::sqrt(deviation(spread));
  for (size_t i = 0; i < kPilotAlphas; ++i)
    sums->l2_roots[i] += std::sqrt(std::sqrt(std::max(l2[i].of(spread, spreads), 0.0)));
}

// Returns the blocks that touch the region, whole except at the border of the frame, as one region.
Region grown_to_blocks(const Region& r, const Region& full) {
  const auto down = [](int32_t x) { return film::pixel_block_of(x, kBlockSide) * kBlockSide; };
  return film::intersection({down(r.x0), down(r.y0), down(r.x1 - 1) + kBlockSide, down(r.y1 - 1) + kBlockSide}, full);
}

// Averages each block with the blocks around it, twice: the few samples of one block do not show rare failures.
std::vector<PilotSums> spread_out(const film::PixelBlockGrid& blocks, std::vector<PilotSums> sums) {
  for (int step = 0; step < 2; ++step) {
    std::vector<PilotSums> next(sums.size());
    for (size_t i = 0; i < sums.size(); ++i) {
      for_each_around(blocks, i, [&](size_t other, double weight) { next[i].add(sums[other], weight); });
    }
    sums = std::move(next);
  }
  return sums;
}

Benefit benefit_of(const PilotSums& sums, bool is_l2) {
  return is_l2 ? estimate_benefit_for_l2(sums) : estimate_benefit(sums);
}

// Returns which blocks have gradients. L2 minimises one error for the whole image, and outliers in one block outweigh
// everything else, so its blocks are chosen together. Where rows are weighted by their noise, each block is chosen by
// itself.
std::vector<bool> choose(const film::PixelBlockGrid& blocks, const std::vector<PilotSums>& sums,
                         uint32_t reconstruction) {
  const bool is_l2 = reconstruction == GRADUS_RECONSTRUCTION_L2;
  std::vector<Benefit> benefits;
  for (const PilotSums& around : spread_out(blocks, sums)) benefits.push_back(benefit_of(around, is_l2));
  if (is_l2) {
    std::vector<double> pixels;
    for (const Region& block : blocks.blocks) pixels.push_back(double(block.area()));
    return choose_blocks(benefits, pixels);
  }
  std::vector<bool> chosen;
  chosen.reserve(benefits.size());
  for (const Benefit& benefit : benefits) chosen.push_back(benefit.pays());
  return chosen;
}

}  // namespace

GradusSettings pilot_settings(GradusSettings settings) {
  // The result must not depend on seed and frame, so that renders that are merged have the same gradients, and an
  // unchanged scene has the same map in all frames.
  settings.seed = kSeed;
  settings.frame = 0;
  settings.passes = 0;
  settings.first_sample = 0;
  return settings;
}

GradientMap run_pilot(const integrator::Integrator& integrator, const GradusSettings& settings, uint32_t reconstruction,
                      const Region& region, int channels, const std::atomic<bool>& stop,
                      const Interruption& interruption) {
  const Region full{0, 0, int32_t(settings.width), int32_t(settings.height)};
  const bool is_l2 = reconstruction == GRADUS_RECONSTRUCTION_L2;
  const auto is_stopped = [&stop] { return stop.load(std::memory_order_relaxed); };
  // Blocks at the border of the region are judged by those beyond it, too; blocks of L2 by all of the frame.
  const film::PixelBlockGrid blocks(is_l2 ? full : grown_to_blocks(grown(region, 2 * kBlockSide, full), full),
                                    kBlockSide);
  const L2Noises l2 = l2_noises(settings, reconstruction);
  std::vector<PilotSums> sums(blocks.blocks.size());
  std::vector<uint8_t> done(sums.size(), 0);
  std::atomic<uint64_t> cpu{0};  // nanoseconds
  const auto look_at = [&](size_t i) {
    if (is_stopped()) return true;
    const FlushDenormals flush;
    const ScopedThreadTimer timer(&cpu);
    film::Counters counters;
    film::Film film(settings.width, settings.height, grown(blocks.blocks[i], 1, full), channels, 1, true);
    const std::vector<size_t> pixels = pixels_of(blocks.blocks[i], film, settings.seed);
    std::vector<uint8_t> map(size_t(film.region.area()), 0);
    for (const size_t pixel : pixels) map[pixel] = 1;
    integrator::WorkUnit unit;
    unit.tile = blocks.blocks[i];
    unit.count = kPilotSamples;
    unit.pixel_map = &map;
    integrator.sample(unit, &film, &counters, stop);
    if (is_stopped()) return true;
    for (const size_t pixel : pixels) add_pixel(film, pixel, l2, &sums[i]);
    sums[i].plain_rays = double(counters.rays_primary + counters.rays_bounce + counters.rays_shadow);
    sums[i].shift_rays = double(counters.rays_shift);
    sums[i].shift_shadow_rays = double(counters.rays_shift_shadow);
    done[i] = 1;
    return interruption.is_due();
  };
  while (!run_until_pause(&done, look_at)) {
    if (is_stopped()) return {};
    interruption.run();
  }
  const std::vector<bool> chosen = choose(blocks, sums, reconstruction);
  GradientMap map;
  map.cpu_seconds = 1e-9 * double(cpu.load());
  map.pixels.assign(size_t(region.area()), 0);
  PilotSums total;
  int64_t kept = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    map.samples += kPilotSamples * uint64_t(sums[i].pixels);
    const Region part = film::intersection(blocks.blocks[i], region);
    if (part.width() <= 0 || part.height() <= 0) continue;
    total.add(sums[i], 1.0);
    if (!chosen[i]) continue;
    film::fill(part, region, uint8_t{1}, &map.pixels);
    kept += part.area();
  }
  map.share = double(kept) / double(region.area());
  map.benefit = benefit_of(total, is_l2);
  return map;
}

void explain(const GradientMap& map, Reasons* chosen, Reasons* skipped) {
  char text[200];
  std::snprintf(text, sizeof(text),
                "a pilot of %llu discarded samples estimates %.2f times the noise at %.1f times the CPU time with them "
                "(mean of the whole image)",
                static_cast<unsigned long long>(map.samples), map.benefit.error, map.benefit.cost);
  if (map.none()) {
    skipped->emplace_back("gradients",
                          "they reduce the error at equal time in no part of the image: " + std::string(text));
    return;
  }
  chosen->emplace_back("gradients in " + std::to_string(std::lround(100.0 * map.share)) + " % of the image", text);
}

}  // namespace gradus::render
