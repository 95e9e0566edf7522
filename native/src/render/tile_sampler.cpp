#include "render/tile_sampler.h"

#include <algorithm>
#include <numeric>

#include "base/clock.h"
#include "base/fpu.h"
#include "film/pixel_blocks.h"
#include "render/pausable_loop.h"

namespace gradus::render {
namespace {

uint64_t rays_of(const film::Counters& c) {
  return c.rays_primary + c.rays_bounce + c.rays_shadow + c.rays_shift + c.rays_shift_shadow;
}

// Returns whether any pixel of a tile has a value other than 0.
template <class T>
bool has_pixels(const std::vector<T>& pixels, const Region& tile, const Region& region) {
  for (int32_t y = tile.y0; y < tile.y1; ++y) {
    const auto row = pixels.begin() + ptrdiff_t(region.index(tile.x0, y));
    if (std::any_of(row, row + tile.width(), [](T value) { return value != 0; })) return true;
  }
  return false;
}

// Returns the sum of the values of the pixels of a tile.
uint64_t sum_of(const std::vector<uint32_t>& pixels, const Region& tile, const Region& region) {
  uint64_t sum = 0;
  for (int32_t y = tile.y0; y < tile.y1; ++y) {
    const auto row = pixels.begin() + ptrdiff_t(region.index(tile.x0, y));
    sum = std::accumulate(row, row + tile.width(), sum);
  }
  return sum;
}

}  // namespace

TileSampler::TileSampler(const integrator::Integrator& integrator, std::vector<Region> tiles,
                         const GradientMap& gradients, const std::vector<uint8_t>& edges, AdaptiveSampling* adaptive,
                         const Replay* replay, const std::atomic<bool>& stop, film::Film* film)
    : integrator_(integrator),
      tiles_(std::move(tiles)),
      gradients_(gradients),
      edges_(edges),
      adaptive_(adaptive),
      replay_(replay),
      stop_(stop),
      film_(film),
      first_sample_(film->settings.first_sample) {}

void TileSampler::start_batch(uint32_t begin, uint32_t end) {
  begin_ = begin;
  end_ = end;
  counts_ = nullptr;
  done_.assign(tiles_.size(), 0);
}

void TileSampler::start_counted_batch(uint32_t first, const std::vector<uint32_t>* counts) {
  start_batch(first - first_sample_, first - first_sample_);
  counts_ = counts;
  std::ranges::transform(tiles_, done_.begin(),
                         [&](const Region& tile) { return !has_pixels(*counts, tile, film_->region); });
}

bool TileSampler::run(const AfterTile& after_tile) {
  return run_until_pause(&done_, [&](size_t tile) { return sample_tile(tile, after_tile); });
}

bool TileSampler::sample_tile(size_t tile, const AfterTile& after_tile) {
  if (stop_.load(std::memory_order_relaxed)) return true;
  const FlushDenormals flush;
  const ScopedThreadTimer timer(&cpu_);
  integrator::WorkUnit unit;
  unit.tile = tiles_[tile];
  unit.first_sample = first_sample_ + begin_;
  unit.count = end_ - begin_;
  if (!gradients_.all() && !gradients_.none()) unit.gradient_map = &gradients_.pixels;
  if (!edges_.empty()) unit.edge_map = &edges_;
  unit.count_map = counts_;
  if (replay_ != nullptr) unit.replay_map = &replay_->replay_map;
  if (replay_ != nullptr && !replay_->counts.empty()) unit.count_map = &replay_->counts;
  const film::Counters counters = counts_ != nullptr   ? sample(unit)
                                  : adaptive_          ? sample_blocks(unit)
                                  : replay_ != nullptr ? sample_replay(unit)
                                                       : sample(unit);
  done_[tile] = 1;
  const uint64_t samples =
      counts_ != nullptr ? sum_of(*counts_, unit.tile, film_->region) : uint64_t(unit.tile.area()) * unit.count;
  const bool pause = after_tile(unit.tile, samples);
  const std::lock_guard lock(counters_mutex_);
  film_->counters.add(counters);
  return pause;
}

film::Counters TileSampler::sample(const integrator::WorkUnit& unit) {
  film::Counters counters;
  integrator_.sample(unit, film_, &counters, stop_);
  return counters;
}

// Replays the samples of the components that share the source pixels of the surface, then those with their own.
film::Counters TileSampler::sample_replay(integrator::WorkUnit unit) {
  const ComponentReplays& components = replay_->components;
  if (!components.shared.empty()) unit.component_map = &components.shared;
  film::Counters sum = sample(unit);
  unit.adds_components = true;
  for (const ComponentReplay& replay : components.own) {
    if (!has_pixels(replay.pixels, unit.tile, film_->region)) continue;
    unit.replay_map = &replay.replay_map;
    unit.pixel_map = &replay.pixels;
    unit.component_map = &replay.components;
    sum.add(sample(unit));
  }
  return sum;
}

// Samples block by block, so that the cost of each block is known.
film::Counters TileSampler::sample_blocks(integrator::WorkUnit unit) {
  unit.first_map = &adaptive_->batch().first;
  unit.count_map = &adaptive_->batch().count;
  film::Counters sum;
  for (const Region& block : film::make_pixel_blocks(unit.tile)) {
    unit.tile = block;
    const film::Counters counters = sample(unit);
    adaptive_->add_rays(block, rays_of(counters));
    sum.add(counters);
  }
  return sum;
}

}  // namespace gradus::render
