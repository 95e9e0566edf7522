#include "render/adaptive_sampling.h"

#include <algorithm>
#include <cmath>

#include "frame/cells.h"
#include "render/sample_shares.h"

namespace gradus {
namespace {

void fill(const Region& cell, const Region& region, uint32_t value, std::vector<uint32_t>* map) {
  for (int32_t y = cell.y0; y < cell.y1; ++y) {
    const size_t first = size_t(y - region.y0) * size_t(region.width()) + size_t(cell.x0 - region.x0);
    std::fill_n(map->begin() + ptrdiff_t(first), cell.width(), value);
  }
}

}  // namespace

AdaptiveSampling::AdaptiveSampling(const Frame& frame, float threshold, uint32_t first_check)
    : region_(frame.region),
      first_sample_(frame.settings.first_sample),
      threshold_(threshold),
      first_check_(first_check),
      cells_(make_cells(frame.region)),
      columns_(lattice_cell(frame.region.x1 - 1) - lattice_cell(frame.region.x0) + 1),
      rays_(cells_.size(), 0),
      spread_(cells_.size(), 1.0),
      done_(cells_.size(), false) {
  for (const Region& cell : cells_) {
    const size_t i = frame.index(cell.x0, cell.y0);
    taken_.push_back(frame.count[0][i] + frame.count[1][i]);
  }
  begun_with_ = taken_;
}

void AdaptiveSampling::judge(const std::vector<CellNoise>& noise) {
  judged_ = true;
  for (size_t i = 0; i < cells_.size(); ++i) {
    spread_[i] = noise[i].spread * std::sqrt(double(taken_[i]));
    if (taken_[i] >= first_check_ && noise[i].relative_error < threshold_) done_[i] = true;  // NaN goes on
  }
}

bool AdaptiveSampling::all_done() const {
  return std::all_of(done_.begin(), done_.end(), [](bool done) { return done; });
}

size_t AdaptiveSampling::index(int32_t x, int32_t y) const {
  const int32_t column = lattice_cell(x) - lattice_cell(region_.x0), row = lattice_cell(y) - lattice_cell(region_.y0);
  return size_t(row) * size_t(columns_) + size_t(column);
}

// With the cells around, the near ones counting more: a cell where no light was found yet lies beside others where it was.
double AdaptiveSampling::smooth_spread(size_t cell) const {
  const int column = int(cell) % columns_, row = int(cell) / columns_, rows = int(cells_.size()) / columns_;
  double sum = 0.0, weights = 0.0;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns_ - 1); ++x) {
      const double weight = (x == column ? 2.0 : 1.0) * (y == row ? 2.0 : 1.0);
      sum += weight * spread_[size_t(y * columns_ + x)];
      weights += weight;
    }
  }
  return sum / weights;
}

// 1 where none were counted: before the first batch of a render that goes on from a frame.
double AdaptiveSampling::rays_per_sample(size_t cell) const {
  const double samples = double(cells_[cell].area()) * (taken_[cell] - begun_with_[cell]);
  return rays_[cell] > 0 ? double(rays_[cell]) / samples : 1.0;
}

void AdaptiveSampling::start_batch(uint32_t mean) {
  std::vector<CellShare> shares;
  for (size_t i = 0; i < cells_.size(); ++i) {
    shares.push_back({cells_[i].area(), taken_[i], smooth_spread(i) / std::sqrt(rays_per_sample(i)), !done_[i]});
  }
  const std::vector<uint32_t> counts = judged_ ? share_samples(shares, mean) : std::vector<uint32_t>(cells_.size(), mean);
  batch_.first.resize(size_t(region_.area()));
  batch_.count.resize(size_t(region_.area()));
  for (size_t i = 0; i < cells_.size(); ++i) {
    fill(cells_[i], region_, first_sample_ + taken_[i], &batch_.first);
    fill(cells_[i], region_, counts[i], &batch_.count);
    taken_[i] += counts[i];
  }
}

uint32_t AdaptiveSampling::most_taken() const { return *std::max_element(taken_.begin(), taken_.end()); }

}  // namespace gradus
