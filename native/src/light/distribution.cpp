#include "light/distribution.h"

#include <immintrin.h>

#include <algorithm>
#include <bit>

#include <tbb/parallel_for.h>

namespace gradus::light {

namespace {

// Returns how many of the 16 values of a node are at most u.
uint32_t count_up_to(const float* node, float u) {
  const __m256 limit = _mm256_set1_ps(u);
  const auto passed = [&](const float* values) {
    return static_cast<uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(_mm256_loadu_ps(values), limit, _CMP_LE_OQ)));
  };
  return static_cast<uint32_t>(std::popcount(passed(node) | passed(node + 8) << 8));
}

// Returns the index of the cell that contains x.
uint32_t cell_at(float x, uint32_t count) { return std::min(uint32_t(std::max(x, 0.0f) * float(count)), count - 1); }

}  // namespace

CumulativeDistributions::CumulativeDistributions(uint32_t cells, uint32_t count) : cells_(cells) {
  std::array<uint32_t, kMaxLevels> sizes;  // of the levels from the lowest
  for (uint32_t nodes = cells; levels_ == 0 || nodes > 1; ++levels_) {
    nodes = (nodes + kNode - 1) / kNode;
    sizes[levels_] = nodes * kNode;
  }
  for (uint32_t k = 0; k < levels_; ++k) begin_[k + 1] = begin_[k] + sizes[levels_ - 1 - k];
  constexpr float kAboveAll = 2.0f;
  values_.assign(size_t(begin_[levels_]) * count, kAboveAll);
}

// The sum runs in double precision, and the last value is exactly 1.
template <class Value>
double CumulativeDistributions::set(uint32_t index, const Value& value) {
  double sum = 0.0;
  for (uint32_t i = 0; i < cells_; ++i) sum += value(i);
  float* first = values_.data() + size_t(index) * begin_[levels_];
  float* level = first + begin_[levels_ - 1];
  double running = 0.0;
  for (uint32_t i = 0; i < cells_; ++i) {
    running += sum > 0.0 ? value(i) / sum : 1.0 / cells_;
    level[i] = float(std::min(running, 1.0));
  }
  level[cells_ - 1] = 1.0f;
  uint32_t size = cells_;
  for (uint32_t k = levels_ - 1; k > 0; --k) {
    const float* below = first + begin_[k];
    for (uint32_t i = 0; i * kNode < size; ++i) first[begin_[k - 1] + i] = below[std::min((i + 1) * kNode, size) - 1];
    size = (size + kNode - 1) / kNode;
  }
  return sum;
}

uint32_t CumulativeDistributions::find(uint32_t index, float u) const {
  const float* first = values_.data() + size_t(index) * begin_[levels_];
  uint32_t found = 0;
  for (uint32_t k = 0; k < levels_; ++k)
    found = found * kNode + count_up_to(first + begin_[k] + size_t(found) * kNode, u);
  return found;
}

float CumulativeDistributions::within(uint32_t index, uint32_t cell, float u) const {
  const float width = probability(index, cell);
  const float offset = width > 0.0f ? (u - lower(index, cell)) / width : 0.5f;
  constexpr float kBelowOne = 0.99999994f;
  return std::min((float(cell) + std::clamp(offset, 0.0f, kBelowOne)) / float(cells_), kBelowOne);
}

Distribution2D::Distribution2D(uint32_t width, uint32_t height, const std::vector<float>& values)
    : width_(width), height_(height), columns_(width, height), rows_(height, 1) {
  std::vector<double> sums(height);
  tbb::parallel_for(0u, height, [&](uint32_t y) {
    const float* row = values.data() + size_t(y) * width;
    sums[y] = columns_.set(y, [row](uint32_t x) { return double(row[x]); });
  });
  rows_.set(0, [&sums](uint32_t y) { return sums[y]; });
}

Vec2 Distribution2D::sample(const Vec2& u) const {
  const uint32_t y = rows_.find(0, u.y);
  const uint32_t x = columns_.find(y, u.x);
  return {columns_.within(y, x, u.x), rows_.within(0, y, u.y)};
}

float Distribution2D::density(const Vec2& p) const {
  const uint32_t x = cell_at(p.x, width_), y = cell_at(p.y, height_);
  return columns_.probability(y, x) * float(width_) * rows_.probability(0, y) * float(height_);
}

}  // namespace gradus::light
