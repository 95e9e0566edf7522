#include "render/sample_allocation.h"

#include <algorithm>
#include <cmath>

namespace gradus::render {
namespace {

// Returns the spreads, replaced where they are not finite (by the maximum) or too small, so that all are positive. All
// are 1 if none is positive.
std::vector<double> usable_spreads(const std::vector<BlockShare>& blocks) {
  double largest = 0.0;
  for (const BlockShare& block : blocks) {
    if (std::isfinite(block.spread)) largest = std::max(largest, block.spread);
  }
  if (!(largest > 0.0)) return std::vector<double>(blocks.size(), 1.0);
  std::vector<double> spreads;
  for (const BlockShare& block : blocks)
    spreads.push_back(std::isfinite(block.spread) ? std::max(block.spread, 1e-6 * largest) : largest);
  return spreads;
}

class Shares {
 public:
  Shares(const std::vector<BlockShare>& blocks, uint32_t mean)
      : blocks_(blocks), spreads_(usable_spreads(blocks)), quantum_(mean >= 4 ? 2 : 1) {
    double pixels = 0.0, taken = 0.0;
    for (const BlockShare& block : blocks) {
      if (!block.continues) continue;
      pixels += double(block.pixels);
      taken += double(block.pixels) * block.taken;
    }
    mean_in_all_ = pixels > 0.0 ? taken / pixels + mean : 0.0;
    budget_ = pixels * mean;
    factor_ = find_factor();
  }

  std::vector<uint32_t> rounded() const {
    std::vector<uint32_t> counts(blocks_.size(), 0);
    double left_over = 0.0;  // samples, summed over pixels, that rounding has not assigned yet
    for (size_t i = 0; i < blocks_.size(); ++i) {
      if (!blocks_[i].continues) continue;
      const double due = wanted(i, factor_), pixels = double(blocks_[i].pixels);
      const double steps = std::floor((due + left_over / pixels) / quantum_ + 0.5);
      counts[i] = uint32_t(std::max(steps, 1.0)) * quantum_;
      left_over += (due - counts[i]) * pixels;
    }
    return counts;
  }

 private:
  double wanted(size_t i, double factor) const {
    const double in_all = std::clamp(factor * spreads_[i], kMinShare * mean_in_all_, kMaxShare * mean_in_all_);
    return std::max(in_all - blocks_[i].taken, double(quantum_));
  }

  double total(double factor) const {
    double sum = 0.0;
    for (size_t i = 0; i < blocks_.size(); ++i)
      sum += blocks_[i].continues ? double(blocks_[i].pixels) * wanted(i, factor) : 0.0;
    return sum;
  }

  // Finds the factor for which the total number of samples is the budget, by bisection: total() is monotone.
  double find_factor() const {
    double low = 0.0, high = kMaxShare * mean_in_all_ / *std::min_element(spreads_.begin(), spreads_.end());
    for (int step = 0; step < 100; ++step) {
      const double middle = 0.5 * (low + high);
      (total(middle) < budget_ ? low : high) = middle;
    }
    return high;
  }

  const std::vector<BlockShare>& blocks_;
  std::vector<double> spreads_;
  uint32_t quantum_;
  double mean_in_all_ = 0.0, budget_ = 0.0, factor_ = 0.0;
};

}  // namespace

std::vector<uint32_t> allocate_samples(const std::vector<BlockShare>& blocks, uint32_t mean) {
  return blocks.empty() ? std::vector<uint32_t>() : Shares(blocks, mean).rounded();
}

}  // namespace gradus::render
