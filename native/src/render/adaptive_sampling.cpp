#include "render/adaptive_sampling.h"

#include <algorithm>
#include <cmath>

#include "render/sample_shares.h"

namespace gradus {

AdaptiveSampling::AdaptiveSampling(const Frame& frame, float threshold, uint32_t first_check)
    : region_(frame.region),
      first_sample_(frame.settings.first_sample),
      threshold_(threshold),
      first_check_(first_check),
      grid_(frame.region),
      rays_(grid_.cells.size(), 0),
      spread_(grid_.cells.size(), 1.0),
      stopped_(grid_.cells.size(), 0) {
  for (const Region& cell : grid_.cells) {
    taken_.push_back(samples_at(frame, frame.index(cell.x0, cell.y0)));
  }
  const bool goes_on = !frame.shared.rays.empty();
  uncounted_ = goes_on ? frame.shared.uncounted : taken_.front();
  if (!goes_on) return;
  rays_ = frame.shared.rays;
  stopped_ = frame.shared.stopped;
}

void AdaptiveSampling::judge(const std::vector<CellNoise>& noise) {
  judged_ = true;
  for (size_t i = 0; i < grid_.cells.size(); ++i) {
    spread_[i] = noise[i].spread * std::sqrt(double(taken_[i]));
    if (taken_[i] >= first_check_ && noise[i].relative_error < threshold_) stopped_[i] = 1;  // NaN goes on
  }
}

bool AdaptiveSampling::all_done() const {
  return std::all_of(stopped_.begin(), stopped_.end(), [](uint8_t stopped) { return stopped != 0; });
}

size_t AdaptiveSampling::index(int32_t x, int32_t y) const {
  return grid_.index(lattice_cell(x) - lattice_cell(region_.x0), lattice_cell(y) - lattice_cell(region_.y0));
}

// With the cells around: a cell where no light was found yet lies beside others where it was.
double AdaptiveSampling::smooth_spread(size_t cell) const {
  double sum = 0.0, weights = 0.0;
  for_each_around(grid_, cell, [&](size_t i, double weight) {
    sum += weight * spread_[i];
    weights += weight;
  });
  return sum / weights;
}

// 1 where none were counted: before the first batch of a render that goes on from samples that were not taken for it.
double AdaptiveSampling::rays_per_sample(size_t cell) const {
  const double samples = double(grid_.cells[cell].area()) * (taken_[cell] - uncounted_);
  return rays_[cell] > 0 ? double(rays_[cell]) / samples : 1.0;
}

void AdaptiveSampling::start_batch(uint32_t mean) {
  std::vector<CellShare> shares;
  for (size_t i = 0; i < grid_.cells.size(); ++i) {
    shares.push_back({grid_.cells[i].area(), taken_[i], smooth_spread(i) / std::sqrt(rays_per_sample(i)), stopped_[i] == 0});
  }
  const std::vector<uint32_t> counts = judged_ ? share_samples(shares, mean) : std::vector<uint32_t>(grid_.cells.size(), mean);
  batch_.first.resize(size_t(region_.area()));
  batch_.count.resize(size_t(region_.area()));
  for (size_t i = 0; i < grid_.cells.size(); ++i) {
    fill(grid_.cells[i], region_, first_sample_ + taken_[i], &batch_.first);
    fill(grid_.cells[i], region_, counts[i], &batch_.count);
    taken_[i] += counts[i];
  }
}

uint32_t AdaptiveSampling::most_taken() const { return *std::max_element(taken_.begin(), taken_.end()); }

}  // namespace gradus
