#include "render/small_components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/clock.h"
#include "base/fpu.h"
#include "base/text_list.h"
#include "film/pixel_blocks.h"
#include "path/sampler.h"

namespace gradus::render {
namespace {

// Maximum side in pixels of the blocks with one test pixel each. Blocks of a small film are smaller, so that there are
// about kMinPixels test pixels.
constexpr int32_t kMaxBlockSide = 16;
constexpr int64_t kMinPixels = 1024;
constexpr uint32_t kTestSamples = 4;
// Side of a group, in blocks. The light of a component in a group is compared with the light of a typical group.
constexpr int32_t kBlocksPerGroupSide = 4;
// A component is small if it has at most these shares of the typical light, in every group and on average.
constexpr double kSmallInGroup = 1e-2, kSmallInAll = 1e-3;

using Light = std::array<double, lpe::kMaxComponents>;

int32_t block_side(const Region& film) {
  return std::clamp(int32_t(std::sqrt(double(film.area()) / double(kMinPixels))), int32_t{1}, kMaxBlockSide);
}

// Returns a random pixel of the block, so that no regular pattern of the image aligns with all test pixels.
Region pixel_of(const Region& block, uint32_t seed) {
  const uint32_t h = path::combine(path::combine(seed, uint32_t(block.x0)), uint32_t(block.y0));
  const int32_t x = block.x0 + int32_t((h & 0xffffu) % uint32_t(block.width())),
                y = block.y0 + int32_t((h >> 16) % uint32_t(block.height()));
  return {x, y, x + 1, y + 1};
}

// Returns the light of each component in a film of one pixel: mean of the channels, summed over samples.
Light light_of(const film::Film& film) {
  Light light{};
  for (size_t c = 0; c < film.components.size(); ++c) {
    const Radiance sum = film.components[c].primal[0][0] + film.components[c].primal[1][0];
    light[c] = std::fabs(double(sum.x) + sum.y + sum.z) / 3.0;
  }
  return light;
}

void add(const Light& light, Light* to) {
  for (size_t c = 0; c < light.size(); ++c) (*to)[c] += light[c];
}

double sum_of(const Light& light) {
  double sum = 0.0;
  for (const double part : light) sum += part;
  return sum;
}

// Returns the median light of the groups, which a firefly does not change.
double typical(const std::vector<Light>& groups) {
  std::vector<double> sums;
  for (const Light& group : groups) sums.push_back(sum_of(group));
  const auto middle = sums.begin() + ptrdiff_t(sums.size() / 2);
  std::nth_element(sums.begin(), middle, sums.end());
  return *middle;
}

bool is_small(const std::vector<Light>& groups, size_t component, double light) {
  double sum = 0.0, maximum = 0.0;
  for (const Light& group : groups) {
    sum += group[component];
    maximum = std::max(maximum, group[component]);
  }
  return maximum <= kSmallInGroup * light && sum <= kSmallInAll * light * double(groups.size());
}

// Returns the mean light of a test pixel, for each group of the film. Adds the CPU time of the threads to `cpu`, in
// nanoseconds.
std::vector<Light> measure_groups(const integrator::Integrator& integrator, const GradusSettings& settings,
                                  const Region& film, int components, int channels, const std::atomic<bool>& stop,
                                  std::atomic<uint64_t>* cpu) {
  const int32_t side = block_side(film);
  const std::vector<Region> groups = film::make_pixel_blocks(film, kBlocksPerGroupSide * side);
  std::vector<Light> light(groups.size());
  tbb::parallel_for(size_t{0}, light.size(), [&](size_t i) {
    const FlushDenormals flush;
    const ScopedThreadTimer timer(cpu);
    film::Counters counters;
    const std::vector<Region> blocks = film::make_pixel_blocks(groups[i], side);
    for (const Region& block : blocks) {
      if (stop.load(std::memory_order_relaxed)) return;
      integrator::WorkUnit unit;
      unit.tile = pixel_of(block, settings.seed);
      unit.count = kTestSamples;
      film::Film pixel(settings.width, settings.height, unit.tile, channels, components, false);
      integrator.sample(unit, &pixel, &counters, stop);
      add(light_of(pixel), &light[i]);
    }
    for (double& part : light[i]) part /= double(blocks.size());
  });
  return light;
}

}  // namespace

SmallComponents find_small_components(const integrator::Integrator& integrator, const GradusSettings& settings,
                                      const lpe::ComponentSet& set, int channels, const std::atomic<bool>& stop) {
  const Region film{0, 0, int32_t(settings.width), int32_t(settings.height)};
  std::atomic<uint64_t> cpu{0};
  const std::vector<Light> groups = measure_groups(integrator, settings, film, set.count(), channels, stop, &cpu);
  SmallComponents small;
  small.cpu_seconds = 1e-9 * double(cpu.load());
  if (stop.load(std::memory_order_relaxed)) return small;  // cancelled: the result is not complete
  small.samples = kTestSamples * uint64_t(film::make_pixel_blocks(film, block_side(film)).size());
  const double light = typical(groups);
  for (int c = 0; c < set.count(); ++c) {
    if (is_small(groups, size_t(c), light)) small.bits |= 1u << c;
  }
  small.bits &= ~set.residual();
  return small;
}

void explain(const SmallComponents& small, const lpe::ComponentSet& set, Reasons* skipped) {
  std::string names;
  for (int c = 0; c < set.count(); ++c) {
    if ((small.bits >> c & 1) != 0) add_item(&names, set[c].name);
  }
  if (names.empty()) return;
  skipped->emplace_back("components " + names,
                        "automatic: " + std::to_string(small.samples) +
                            " discarded samples found almost no light of them; it is added to Residual");
}

}  // namespace gradus::render
