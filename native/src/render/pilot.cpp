#include "render/pilot.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/fpu.h"
#include "frame/cells.h"
#include "sampling/hash.h"

namespace gradus {
namespace {

// A square of kSquare pixels is judged by a block of kBlock pixels in it and those in the squares around: 1/32 of a sample per pixel.
constexpr int kSquare = 32;
constexpr int kBlock = 4;
constexpr uint32_t kSamples = 2;
// No user's seed, which are below 2³¹: else the samples of frame 0 would be those that are kept.
constexpr uint32_t kSeed = 0xf0696c6fu;

Region grown(const Region& r, int by, const Region& limit) { return intersection({r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by}, limit); }

// Somewhere in the square, so that no pattern of the picture meets all blocks alike.
Region block_of(const Region& square, uint32_t seed) {
  const uint32_t h = combine(combine(seed, uint32_t(square.x0)), uint32_t(square.y0));
  const auto place = [](int32_t begin, int32_t end, uint32_t random) {
    const int32_t free = std::max(end - begin - kBlock, 0);
    return begin + int32_t(random % uint32_t(free + 1));
  };
  const int32_t x = place(square.x0, square.x1, h & 0xffffu), y = place(square.y0, square.y1, h >> 16);
  return intersection({x, y, x + kBlock, y + kBlock}, square);
}

double distance(const Radiance& a, const Radiance& b) {
  const Vec3 d(a.x - b.x, a.y - b.y, a.z - b.z);
  return std::sqrt(double(dot(d, d)) / 3.0);
}

// Every pixel has one sample of each half. A difference of neighbours has such samples from both of its ends, which are alike: √2.
PilotSums sums_of(const Frame& frame, const Region& block, const Counters& rays) {
  const ComponentPlanes& planes = frame.components[0];
  PilotSums sums;
  for (int32_t y = block.y0; y < block.y1; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) {
      const size_t i = frame.index(x, y);
      ++sums.pixels;
      sums.pixel_deviation += distance(planes.primal[0][i], planes.primal[1][i]);
      for (int k = 0; k < kOffsets; ++k) {
        if (!(frame.pair_count[0][k][i] > 0.0f)) continue;
        ++sums.differences;
        sums.difference_deviation += std::numbers::sqrt2 * distance(planes.gradient[0][k][i], planes.gradient[1][k][i]);
      }
    }
  }
  sums.plain_rays = double(rays.rays_primary + rays.rays_bounce + rays.rays_shadow);
  sums.shift_rays = double(rays.rays_shift + rays.rays_shift_shadow);
  return sums;
}

// Whole squares but for the frame's border: all that touch the region.
Region grown_to_squares(const Region& r, const Region& full) {
  const auto down = [](int32_t x) { return lattice_cell(x, kSquare) * kSquare; };
  return intersection({down(r.x0), down(r.y0), down(r.x1 - 1) + kSquare, down(r.y1 - 1) + kSquare}, full);
}

// What a square and those around it have shown.
PilotSums around(const CellGrid& squares, const std::vector<PilotSums>& sums, size_t square) {
  PilotSums result;
  for_each_around(squares, square, [&](size_t i, double weight) { result.add(sums[i], weight); });
  return result;
}

}  // namespace

GradusSettings pilot_settings(GradusSettings settings) {
  // The same for all seeds and frames: renders that are merged have the same gradients, and a scene that stands still the same map.
  settings.seed = kSeed;
  settings.frame = 0;
  settings.passes = 0;
  settings.first_sample = 0;
  return settings;
}

GradientMap run_pilot(const Integrator& integrator, const GradusSettings& settings, const Region& region, int channels,
                      const std::atomic<bool>& stop) {
  const Region full{0, 0, int32_t(settings.width), int32_t(settings.height)};
  // Squares at the region's border are judged by those beyond, too.
  const CellGrid squares(grown_to_squares(grown(region, kSquare, full), full), kSquare);
  std::vector<PilotSums> sums(squares.cells.size());
  tbb::parallel_for(size_t{0}, sums.size(), [&](size_t i) {
    if (stop.load(std::memory_order_relaxed)) return;
    const FlushDenormals flush;
    const Region block = block_of(squares.cells[i], settings.seed);
    Frame frame(settings.width, settings.height, grown(block, 1, full), channels, 1, true);
    Counters counters;
    WorkUnit unit;
    unit.tile = block;
    unit.count = kSamples;
    integrator.sample(unit, &frame, &counters, stop);
    sums[i] = sums_of(frame, block, counters);
  });
  GradientMap map;
  map.pixels.assign(size_t(region.area()), 0);
  PilotSums total;
  int64_t kept = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    const Region part = intersection(squares.cells[i], region);
    if (part.width() <= 0 || part.height() <= 0) continue;
    total.add(sums[i], 1.0);
    if (!estimate_benefit(around(squares, sums, i)).pays()) continue;
    fill(part, region, uint8_t{1}, &map.pixels);
    kept += part.area();
  }
  map.share = double(kept) / double(region.area());
  map.benefit = estimate_benefit(total);
  map.samples = kSamples * uint64_t(kBlock * kBlock) * sums.size();
  return map;
}

void explain(const GradientMap& map, Reasons* chosen, Reasons* skipped) {
  char text[200];
  std::snprintf(
      text, sizeof(text),
      "a pilot of %llu samples, thrown away, expects them to leave %.2f of the noise for %.1f times the CPU time (all of the picture)",
      static_cast<unsigned long long>(map.samples), map.benefit.error, map.benefit.cost);
  if (map.none()) {
    skipped->emplace_back("gradients", "they pay nowhere: " + std::string(text));
    return;
  }
  chosen->emplace_back("gradients in " + std::to_string(std::lround(100.0 * map.share)) + " % of the picture", text);
}

}  // namespace gradus
