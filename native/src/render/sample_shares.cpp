#include "render/sample_shares.h"

#include <algorithm>
#include <cmath>

namespace gradus {
namespace {

// Spreads that are finite and positive.
std::vector<double> usable_spreads(const std::vector<CellShare>& cells) {
  double largest = 0.0;
  for (const CellShare& cell : cells) {
    if (std::isfinite(cell.spread)) largest = std::max(largest, cell.spread);
  }
  if (!(largest > 0.0)) return std::vector<double>(cells.size(), 1.0);
  std::vector<double> spreads;
  for (const CellShare& cell : cells) spreads.push_back(std::isfinite(cell.spread) ? std::max(cell.spread, 1e-6 * largest) : largest);
  return spreads;
}

class Shares {
 public:
  Shares(const std::vector<CellShare>& cells, uint32_t mean) : cells_(cells), spreads_(usable_spreads(cells)), quantum_(mean >= 4 ? 2 : 1) {
    double pixels = 0.0, taken = 0.0;
    for (const CellShare& cell : cells) {
      if (!cell.goes_on) continue;
      pixels += double(cell.pixels);
      taken += double(cell.pixels) * cell.taken;
    }
    mean_in_all_ = pixels > 0.0 ? taken / pixels + mean : 0.0;
    budget_ = pixels * mean;
    factor_ = find_factor();
  }

  std::vector<uint32_t> rounded() const {
    std::vector<uint32_t> counts(cells_.size(), 0);
    double left_over = 0.0;  // samples of pixels that rounding has not given yet
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (!cells_[i].goes_on) continue;
      const double due = wanted(i, factor_), pixels = double(cells_[i].pixels);
      const double steps = std::floor((due + left_over / pixels) / quantum_ + 0.5);
      counts[i] = uint32_t(std::max(steps, 1.0)) * quantum_;
      left_over += (due - counts[i]) * pixels;
    }
    return counts;
  }

 private:
  double wanted(size_t i, double factor) const {
    const double in_all = std::clamp(factor * spreads_[i], kLeastShare * mean_in_all_, kLargestShare * mean_in_all_);
    return std::max(in_all - cells_[i].taken, double(quantum_));
  }

  double total(double factor) const {
    double sum = 0.0;
    for (size_t i = 0; i < cells_.size(); ++i) sum += cells_[i].goes_on ? double(cells_[i].pixels) * wanted(i, factor) : 0.0;
    return sum;
  }

  // That of which all samples together are the budget; total() does not fall.
  double find_factor() const {
    double low = 0.0, high = kLargestShare * mean_in_all_ / *std::min_element(spreads_.begin(), spreads_.end());
    for (int step = 0; step < 100; ++step) {
      const double middle = 0.5 * (low + high);
      (total(middle) < budget_ ? low : high) = middle;
    }
    return high;
  }

  const std::vector<CellShare>& cells_;
  std::vector<double> spreads_;
  uint32_t quantum_;
  double mean_in_all_ = 0.0, budget_ = 0.0, factor_ = 0.0;
};

}  // namespace

std::vector<uint32_t> share_samples(const std::vector<CellShare>& cells, uint32_t mean) {
  return cells.empty() ? std::vector<uint32_t>() : Shares(cells, mean).rounded();
}

}  // namespace gradus
