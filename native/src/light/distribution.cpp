#include "light/distribution.h"

#include <algorithm>

namespace gradus::light {

namespace {

// Writes the cumulative distribution of `count` values to `out`, which has count + 1 elements and ends at exactly 1.
// The sum runs in double precision. Values that are all zero become uniform. Returns the sum of the values.
template <class Value>
double cumulate(uint32_t count, Value&& value, float* out) {
  double sum = 0.0;
  for (uint32_t i = 0; i < count; ++i) sum += value(i);
  double running = 0.0;
  out[0] = 0.0f;
  for (uint32_t i = 0; i < count; ++i) {
    running += sum > 0.0 ? value(i) / sum : 1.0 / count;
    out[i + 1] = float(std::min(running, 1.0));
  }
  out[count] = 1.0f;
  return sum;
}

// Returns the index of the cell whose interval of the cumulative values contains u. A cell of zero width is never
// returned.
uint32_t find(const float* cumulated, uint32_t count, float u) {
  const float* above = std::upper_bound(cumulated, cumulated + count + 1, u);
  if (above > cumulated + count) above = std::lower_bound(cumulated, cumulated + count + 1, 1.0f);
  return uint32_t(std::max<ptrdiff_t>(0, above - cumulated - 1));
}

// Returns the position in [0, 1) at which the cumulative distribution reaches u, which lies in cell i.
float within(const float* cumulated, uint32_t count, uint32_t i, float u) {
  const float width = cumulated[i + 1] - cumulated[i];
  const float offset = width > 0.0f ? (u - cumulated[i]) / width : 0.5f;
  constexpr float kBelowOne = 0.99999994f;
  return std::min((float(i) + std::clamp(offset, 0.0f, kBelowOne)) / float(count), kBelowOne);
}

// Returns the index of the cell that contains x.
uint32_t cell(float x, uint32_t count) { return std::min(uint32_t(std::max(x, 0.0f) * float(count)), count - 1); }

}  // namespace

Distribution2D::Distribution2D(uint32_t width, uint32_t height, const std::vector<float>& values)
    : width_(width),
      height_(height),
      guide_(size_t(kGuides + 1) * height),
      conditional_(size_t(width + 1) * height),
      marginal_(height + 1) {
  std::vector<double> sums(height);
  for (uint32_t y = 0; y < height; ++y) {
    const float* v = values.data() + size_t(y) * width;
    sums[y] = cumulate(
        width, [v](uint32_t x) { return double(v[x]); }, conditional_.data() + size_t(y) * (width + 1));
    for (uint32_t k = 0; k <= kGuides; ++k)
      guide_[size_t(y) * (kGuides + 1) + k] = find(row(y), width_, float(k) / float(kGuides));
  }
  cumulate(
      height, [&sums](uint32_t y) { return sums[y]; }, marginal_.data());
}

uint32_t Distribution2D::find_in_row(uint32_t y, float u) const {
  const uint32_t* guide =
      guide_.data() + size_t(y) * (kGuides + 1) + std::min(uint32_t(u * float(kGuides)), kGuides - 1);
  return guide[0] + find(row(y) + guide[0], guide[1] - guide[0] + 1, u);
}

Vec2 Distribution2D::sample(const Vec2& u) const {
  const uint32_t y = find(marginal_.data(), height_, u.y);
  const uint32_t x = find_in_row(y, u.x);
  return {within(row(y), width_, x, u.x), within(marginal_.data(), height_, y, u.y)};
}

float Distribution2D::density(const Vec2& p) const {
  const uint32_t x = cell(p.x, width_), y = cell(p.y, height_);
  return (row(y)[x + 1] - row(y)[x]) * float(width_) * (marginal_[y + 1] - marginal_[y]) * float(height_);
}

}  // namespace gradus::light
