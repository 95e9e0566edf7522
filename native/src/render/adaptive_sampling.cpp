#include "render/adaptive_sampling.h"

#include <algorithm>
#include <cmath>

#include "render/sample_allocation.h"

namespace gradus::render {

namespace {

// Returns the number of samples that all pixels of a block have, whatever those at edges have besides.
uint32_t usual_samples(const film::Film& film, const Region& block) {
  uint32_t least = UINT32_MAX;
  for (int32_t y = block.y0; y < block.y1; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) least = std::min(least, film::samples_at(film, film.index(x, y)));
  }
  return least;
}

}  // namespace

AdaptiveSampling::AdaptiveSampling(const film::Film& film, float threshold, uint32_t first_check)
    : region_(film.region),
      first_sample_(film.settings.first_sample),
      threshold_(threshold),
      first_check_(first_check),
      grid_(film.region),
      rays_(grid_.blocks.size(), 0),
      spread_(grid_.blocks.size(), 1.0),
      stopped_(grid_.blocks.size(), 0) {
  for (const Region& block : grid_.blocks) taken_.push_back(usual_samples(film, block));
  const bool continues = !film.shared.rays.empty();
  uncounted_ = continues ? film.shared.uncounted : taken_.front();
  if (!continues) return;
  rays_ = film.shared.rays;
  stopped_ = film.shared.stopped;
}

void AdaptiveSampling::judge(const std::vector<BlockNoise>& noise) {
  judged_ = true;
  for (size_t i = 0; i < grid_.blocks.size(); ++i) {
    spread_[i] = noise[i].spread * std::sqrt(double(taken_[i]));
    // a block with NaN does not stop
    if (taken_[i] >= first_check_ && noise[i].relative_error < threshold_) stopped_[i] = 1;
  }
}

bool AdaptiveSampling::all_done() const {
  return std::all_of(stopped_.begin(), stopped_.end(), [](uint8_t stopped) { return stopped != 0; });
}

size_t AdaptiveSampling::index(int32_t x, int32_t y) const {
  return grid_.index(film::pixel_block_of(x) - film::pixel_block_of(region_.x0),
                     film::pixel_block_of(y) - film::pixel_block_of(region_.y0));
}

// Returns the spread of a block averaged with the blocks around it. A block in which no sample has found light yet
// often lies beside blocks that have some.
double AdaptiveSampling::smooth_spread(size_t block) const {
  double sum = 0.0, weights = 0.0;
  for_each_around(grid_, block, [&](size_t i, double weight) {
    sum += weight * spread_[i];
    weights += weight;
  });
  return sum / weights;
}

// Returns the mean number of rays per sample. It is 1 where none were counted: before the first batch of a render that
// continues samples that were not taken adaptively.
double AdaptiveSampling::rays_per_sample(size_t block) const {
  const double samples = double(grid_.blocks[block].area()) * (taken_[block] - uncounted_);
  return rays_[block] > 0 ? double(rays_[block]) / samples : 1.0;
}

void AdaptiveSampling::start_batch(uint32_t mean) {
  std::vector<BlockShare> shares;
  for (size_t i = 0; i < grid_.blocks.size(); ++i) {
    shares.push_back(
        {grid_.blocks[i].area(), taken_[i], smooth_spread(i) / std::sqrt(rays_per_sample(i)), stopped_[i] == 0});
  }
  const std::vector<uint32_t> counts =
      judged_ ? allocate_samples(shares, mean) : std::vector<uint32_t>(grid_.blocks.size(), mean);
  batch_.first.resize(size_t(region_.area()));
  batch_.count.resize(size_t(region_.area()));
  for (size_t i = 0; i < grid_.blocks.size(); ++i) {
    film::fill(grid_.blocks[i], region_, first_sample_ + taken_[i], &batch_.first);
    film::fill(grid_.blocks[i], region_, counts[i], &batch_.count);
    taken_[i] += counts[i];
  }
}

uint32_t AdaptiveSampling::max_taken() const { return *std::max_element(taken_.begin(), taken_.end()); }

}  // namespace gradus::render
