// Regression in the windows of one octave within a tile, row by row. It sums the moments of blocks, joins blocks to
// windows, solves the windows, and distributes their estimates to the blocks and to their pixels.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "base/fault.h"
#include "reconstruct/regression/local_regression.h"
#include "reconstruct/regression/moments.h"

namespace gradus::reconstruct {

// Number of blocks that a window extends beyond its first one along each axis.
inline constexpr int kReach = 3;
// Number of pixels in a unit of the coordinates: several windows, so that the ridge affects their slopes as little as
// those of the other features.
inline constexpr float kCoordinateUnit = 20.0f;
// Number of pixels of a block that are summed at a time.
inline constexpr int kGroup = 4;

// Input and output of the regression of one image.
struct RegressionTask {
  const RegressionSamples* samples;
  std::vector<Values> values;   // the mean and half the difference if η is estimated, else one image
  std::vector<Field*> results;  // sums over windows until the last lattice is done, then the results
  Field *totals, *bias;         // sums of η and of η · bias
  const RegressionSettings* settings;

  int width() const { return samples->in_windows->weights.width(); }
  int height() const { return samples->in_windows->weights.height(); }
};

// Input and output of one octave on one of the lattices. Its blocks begin `shift` pixels before the image.
template <bool Estimates>
struct OctaveTask {
  using Confidence = std::conditional_t<Estimates, Field, const Field>;
  Octave octave;
  int shift;
  // η of the windows: a channel for each window size, large ones first. The window of first block (i, j) is at
  // (i + kReach, j + kReach).
  Confidence* confidence;
  const Field* coarse;      // estimates of the next coarser octave; null for the coarsest
  Field* window_estimates;  // estimates of this octave; null for the finest, which writes the results
};

inline int ceil_divided(int pixels, int side) { return (pixels + side - 1) / side; }

template <int P, int C, bool Coordinates, bool Estimates>
class Tile {
 public:
  // Prepares the tile of the blocks [x0, x1) × [y0, y1).
  Tile(const RegressionTask& task, const OctaveTask<Estimates>& octave, int x0, int x1, int y0, int y1)
      : task_(task),
        octave_(octave),
        side_(octave.octave.side),
        x0_(x0),
        x1_(x1),
        y0_(y0),
        y1_(y1),
        first_(x0 - kReach),
        width_(x1 - x0 + 2 * kReach),
        unit_(0.5f / kCoordinateUnit * float(side_)),
        pixels_(kGroup * kPixel, width_),
        moments_(M::kCount, width_),
        boxes_(M::kCount, width_),
        pairs_{Rows(M::kCount, width_), Rows(M::kCount, width_)},
        quads_{Rows(M::kCount, width_), Rows(M::kCount, width_), Rows(M::kCount, width_)},
        estimate_(O::kCount, width_),
        small_{Rows(O::kCount, width_), Rows(O::kCount, width_), Rows(O::kCount, width_)},
        large_{Rows(O::kCount, width_), Rows(O::kCount, width_), Rows(O::kCount, width_)},
        columns_{Rows(O::kCount, width_), Rows(O::kCount, width_)} {}

  void run() {
    if (is_black()) return pass_over();
    for (int j = y0_ - kReach; j < y1_ + kReach; ++j) {
      sum_squares(j);
      M::template join<M::kX>(moments_, moments_, 1, unit_, &at(pairs_, j));
      if (j > y0_ - kReach) regress_small(j - 1);
      if (j >= y0_) {
        regress_large(j - 3);
        collect(j - 3);
      }
    }
  }

 private:
  using M = Moments<P, C, Coordinates>;
  using O = WindowEstimates<P, C, Coordinates>;
  enum Size : int { kLarge, kSmall };  // window size
  // kChannels is the number of image channels if the right sides are the mean and half the difference.
  static constexpr int kSides = P * C, kChannels = C / 2;
  static constexpr int B = Coordinates ? P - 2 : P;  // number of features without the coordinates
  // Order of a pixel's planes: features without the constant, weight, values, displacement.
  static constexpr int kWeight = B - 1, kValues = kWeight + 1, kDisplacement = kValues + C,
                       kPixel = kDisplacement + (Coordinates ? 2 : 0);

  template <size_t N>
  static Rows& at(std::array<Rows, N>& ring, int j) {
    return ring[size_t(j + 64 * int(N)) % N];
  }

  // Returns whether all values are 0 that the windows of the tile contain.
  bool is_black() const {
    const int w = task_.width(), h = task_.height();
    const auto at = [&](int square) { return square * side_ - octave_.shift; };
    const int begin = std::clamp(at(x0_ - kReach), 0, w), end = std::clamp(at(x1_ + kReach), 0, w);
    for (int y = std::max(0, at(y0_ - kReach)); y < std::min(h, at(y1_ + kReach)); ++y) {
      for (int c = 0; c < C; ++c) {
        const float* row = value_row(y, c);
        if (std::any_of(row + begin, row + end, [](float value) { return value != 0.0f; })) return false;
      }
    }
    return true;
  }

  // Writes the results of a black tile: all its windows estimate 0 with the maximum confidence. The coarser octave may
  // still contribute other values.
  void pass_over() {
    const float maximum = 1.0f / (float(task_.settings->lattices) * task_.settings->floor);
    if constexpr (Estimates) {
      for (int m = y0_ - kReach; m < y1_; ++m) store_max_confidence(m, maximum);
    }
    for (int m = y0_; m < y1_; ++m) {
      estimate_.clear();
      std::fill_n(estimate_[O::kConfidence], width_, octave_.octave.small ? 2.0f * maximum : maximum);
      if (octave_.coarse != nullptr) add_coarse(m);
      octave_.window_estimates != nullptr ? write_estimates(m) : write_pixels(m);
    }
  }

  // Stores the maximum confidence for all windows whose first block is in row m. Small windows that begin two blocks
  // before the image contain none of its pixels.
  void store_max_confidence(int m, float maximum) {
    for (int x = 0; x < boxes_.width(); x += kLanes) {
      store_confidence(m, kLarge, x, Lanes{} + 0.0625f * maximum);
      if (!octave_.octave.small || m < -1) continue;
      Lanes small{};
      for (int l = 0; l < kLanes; ++l) small[l] = first_ + x + l < -1 ? 0.0f : 0.25f * maximum;
      store_confidence(m, kSmall, x, small);
    }
  }

  // Position of pixel k of group g within its block.
  int pixel_x(int g, int k) const { return side_ == 2 ? k % 2 : (kGroup * g + k) % side_; }
  int pixel_y(int g, int k) const { return side_ == 2 ? k / 2 : (kGroup * g + k) / side_; }
  int pixel_row(int j, int g, int k) const { return j * side_ + pixel_y(g, k) - octave_.shift; }
  int groups() const { return side_ * side_ / kGroup; }
  float coordinate(int i) const { return (float(i) - 0.5f * float(side_ - 1)) / kCoordinateUnit; }

  const float* value_row(int y, int c) const { return task_.values[size_t(c) / 3].in_windows->row(y, c % 3); }
  const float* own_value_row(int y, int c) const { return task_.values[size_t(c) / 3].own->row(y, c % 3); }

  // Reads the k-th pixel of a group for every block of row j, so that the blocks lie next to each other: features, and
  // displacements unless they are null or empty.
  void read_features(const Field& features, const Field* displacement, int j, int g) {
    const bool displaced = Coordinates && displacement != nullptr && displacement->channels() > 0;
    for (int k = 0; k < kGroup; ++k) {
      const int y = pixel_row(j, g, k), dx = pixel_x(g, k), at = k * kPixel;
      const bool inside = y >= 0 && y < task_.height();
      const int of_features = GRADUS_FAULT(window_features_shifted_by_a_row) ? std::max(y - 1, 0) : y;
      for (int c = 0; c + 1 < B; ++c) pick(inside ? features.row(of_features, c) : nullptr, dx, pixels_[at + c]);
      for (int c = 0; c < kPixel - kDisplacement; ++c)
        pick(inside && displaced ? displacement->row(y, c) : nullptr, dx, pixels_[at + kDisplacement + c]);
    }
  }
  // Reads weights and values in the same way.
  void read_samples(int j, int g) {
    for (int k = 0; k < kGroup; ++k) {
      const int y = pixel_row(j, g, k), dx = pixel_x(g, k), at = k * kPixel;
      const bool inside = y >= 0 && y < task_.height();
      pick(inside ? in_windows().weights.row(y) : nullptr, dx, pixels_[at + kWeight]);
      for (int c = 0; c < C; ++c) pick(inside ? value_row(y, c) : nullptr, dx, pixels_[at + kValues + c]);
    }
  }
  const Predictors& in_windows() const { return *task_.samples->in_windows; }

  // Range of blocks whose pixel dx lies in the image.
  int first_inside(int dx) const { return std::max(0, ceil_divided(octave_.shift - dx, side_) - first_); }
  int end_inside(int dx) const { return ceil_divided(task_.width() + octave_.shift - dx, side_) - first_; }

  // Copies pixel dx of each block of a row; 0 outside of the image and in the first and last `margin` blocks.
  void pick(const float* row, int dx, float* to, int margin = 0) const {
    if (row == nullptr) return static_cast<void>(std::fill_n(to, pixels_.width(), 0.0f));
    const int begin = std::max(margin, first_inside(dx)), end = std::min(width_ - margin, end_inside(dx));
    std::fill_n(to, begin, 0.0f);
    row += first_ * side_ + dx - octave_.shift;
    const ptrdiff_t side = side_;
    if (side == 2) {
      for (int x = begin; x < end; ++x) to[x] = row[ptrdiff_t{2} * x];
    } else {
      for (int x = begin; x < end; ++x) to[x] = row[side * x];
    }
    for (int x = std::max(begin, end); x < pixels_.width(); ++x) to[x] = 0.0f;
  }

  // Computes the moments of the blocks of row j.
  void sum_squares(int j) {
    if (j < 0 || j >= ceil_divided(task_.height() + octave_.shift, side_)) return moments_.clear();
    for (int g = 0; g < groups(); ++g) {
      read_features(in_windows().features, &in_windows().displacement, j, g);
      read_samples(j, g);
      for (int x = 0; x < moments_.width(); x += kLanes) g == 0 ? add_pixels<true>(g, x) : add_pixels<false>(g, x);
    }
  }

  // Returns feature i (φ) of pixel k of group g, for eight blocks.
  Lanes feature(int i, int g, int k, int x) const {
    if (i == 0) return Lanes{} + 1.0f;
    if (i < B) return load(pixels_[k * kPixel + i - 1] + x);
    const Lanes displacement = load(pixels_[k * kPixel + kDisplacement + (i == M::kX ? 0 : 1)] + x);
    return (i == M::kX ? coordinate(pixel_x(g, k)) : coordinate(pixel_y(g, k))) +
           (1.0f / kCoordinateUnit) * displacement;
  }

  template <bool First>
  void add_pixels(int g, int x) {
    Lanes basis[P][kGroup], values[C][kGroup];
    for (int k = 0; k < kGroup; ++k) {
      for (int i = 0; i < P; ++i) basis[i][k] = feature(i, g, k, x);
      for (int c = 0; c < C; ++c) values[c][k] = load(pixels_[k * kPixel + kValues + c] + x);
    }
    const auto put = [&](int plane, const Lanes* a, const Lanes* b) {
      Lanes sum = a[0] * b[0];
      for (int k = 1; k < kGroup; ++k) sum += a[k] * b[k];
      float* to = moments_[plane] + x;
      store(First ? sum : sum + load(to), to);
    };
    for (int i = 0; i < P; ++i) {
      Lanes weighted[kGroup];
      for (int k = 0; k < kGroup; ++k) weighted[k] = load(pixels_[k * kPixel + kWeight] + x) * basis[i][k];
      for (int j = 0; j <= i; ++j) put(packed(i, j), weighted, basis[j]);
      for (int c = 0; c < C; ++c) put(M::kRight + C * i + c, weighted, values[c]);
    }
    Lanes weight[kGroup], squared[kGroup] = {};
    for (int k = 0; k < kGroup; ++k) {
      weight[k] = load(pixels_[k * kPixel + kWeight] + x);
      for (int c = 0; c < C; ++c)
        squared[k] += (!Estimates || c < kChannels || GRADUS_FAULT(residual_noise_counts_as_bias) ? 1.0f : -1.0f) *
                      values[c][k] * values[c][k];
    }
    put(M::kSquares, weight, squared);
  }

  // Regresses the windows whose first row of blocks is m.
  void regress_small(int m) {
    M::template join<M::kY>(at(pairs_, m), at(pairs_, m + 1), 0, unit_, &boxes_);
    if (octave_.octave.small) regress(m, kSmall, &at(small_, m));
    M::template join<M::kX>(boxes_, boxes_, 2, 2.0f * unit_, &at(quads_, m));
  }
  void regress_large(int m) {
    M::template join<M::kY>(at(quads_, m), at(quads_, m + 2), 0, 2.0f * unit_, &boxes_);
    regress(m, kLarge, &estimate_);
  }

  // Distributes the estimates of windows to the blocks that they contain. Once a row is complete, writes its results.
  void collect(int m) {
    Rows &large = at(large_, m), &small = at(small_, m), &column = at(columns_, m);
    large.clear();
    O::template split<M::kX>(estimate_, estimate_, 2, 2.0f * unit_, &large);
    if (!octave_.octave.small) small.clear();
    O::template split<M::kY>(large, at(large_, m - 2), 0, 2.0f * unit_, &small);
    column.clear();
    O::template split<M::kX>(small, small, 1, unit_, &column);
    if (m < y0_) return;
    estimate_.clear();
    O::template split<M::kY>(column, at(columns_, m - 1), 0, unit_, &estimate_);
    if (octave_.coarse != nullptr) add_coarse(m);
    octave_.window_estimates != nullptr ? write_estimates(m) : write_pixels(m);
  }

  // Regresses a row of windows, eight at a time: computes their coefficients, their error and their confidence.
  void regress(int m, Size size, Rows* estimate) {
    for (int x = 0; x < boxes_.width(); x += kLanes) regress(m, size, x, estimate);
  }
  void regress(int m, Size size, int x, Rows* estimate) {
    Lanes matrix[packed(P, 0)], solution[kSides];
    for (int i = 0; i < packed(P, 0); ++i) matrix[i] = load(boxes_[i] + x);
    for (int i = 0; i < kSides; ++i) solution[i] = load(boxes_[M::kRight + i] + x);
    const Lanes zero{}, weight = matrix[0], ridge = task_.settings->ridge * weight;
    for (int i = 1; i < P; ++i) matrix[packed(i, i)] += ridge;
    if (!holds_nothing(x)) solve_windows<P, C>(matrix, solution);
    Lanes eta, bias = zero;
    if constexpr (Estimates) {
      Lanes residuals[kChannels] = {load(boxes_[M::kSquares] + x)}, noises[kChannels] = {};
      for (int i = 0; i < P; ++i) {
        const Lanes penalty = i == 0 ? zero : ridge;
        for (int c = 0; c < kChannels; ++c) {
          const Lanes v = solution[C * i + c], d = solution[C * i + kChannels + c];
          const Lanes of_noise = d * load(boxes_[M::kRight + C * i + kChannels + c] + x);
          residuals[c] += of_noise + penalty * d * d - v * (load(boxes_[M::kRight + C * i + c] + x) + penalty * v);
          noises[c] += of_noise - penalty * d * d;
        }
      }
      Lanes residual = zero, noise = zero;
      for (int c = 0; c < kChannels; ++c) {
        residual += residuals[c];
        noise += noises[c];
      }
      const Lanes unit = weight > zero ? 1.0f / (float(kChannels) * weight) : zero;
      bias = (GRADUS_FAULT(window_bias_times_4) ? 4.0f : 1.0f) * unit * residual;
      noise *= GRADUS_FAULT(window_variance_times_4) ? 4.0f : GRADUS_FAULT(window_variance_over_4) ? 0.25f : 1.0f;
      const Lanes error = (bias > zero ? bias : zero) + (noise > zero ? unit * noise : zero) + task_.settings->floor;
      eta = weight > zero ? (size == kSmall ? 0.25f : 0.0625f) / (float(task_.settings->lattices) * error) : zero;
      store_confidence(m, size, x, eta);
    } else {
      eta = load_confidence(m, size, x);
    }
    for (int i = 0; i < kSides; ++i) store(eta * solution[i], (*estimate)[i] + x);
    store(eta, (*estimate)[O::kConfidence] + x);
    store(eta * bias, (*estimate)[O::kBias] + x);
  }

  // Returns whether the right sides of eight windows are all 0.
  bool holds_nothing(int x) const {
    auto any = load(boxes_[M::kRight] + x) != Lanes{};
    for (int i = 1; i < kSides; ++i) any |= load(boxes_[M::kRight + i] + x) != Lanes{};
    for (int l = 0; l < kLanes; ++l) {
      if (any[l] != 0) return false;
    }
    return true;
  }

  // Stores the confidence of eight windows. Exactly one tile stores each window.
  void store_confidence(int m, Size size, int x, const Lanes& eta) {
    if ((m < y0_ && y0_ > 0) || m >= y1_) return;
    for (int l = 0; l < kLanes; ++l) {
      const int i = first_ + x + l;
      if ((i >= x0_ || x0_ == 0) && i < x1_) octave_.confidence->row(m + kReach, size)[i + kReach] = eta[l];
    }
  }
  Lanes load_confidence(int m, Size size, int x) const {
    Lanes eta{};
    if (m + kReach >= octave_.confidence->height()) return eta;
    for (int l = 0; l < kLanes; ++l) {
      const int i = first_ + x + l + kReach;
      if (i < octave_.confidence->width()) eta[l] = octave_.confidence->row(m + kReach, size)[i];
    }
    return eta;
  }

  void add_coarse(int m) {
    const float above = m % 2 == 0 ? -unit_ : unit_;
    for (int i = 0; i < O::kCount; ++i) {
      const float* from = octave_.coarse->row(m / 2, i);
      float* to = estimate_[i];
      for (int x = kReach; x < width_ - kReach; ++x) to[x] += from[(first_ + x) / 2];
    }
    if constexpr (Coordinates) {
      for (int c = 0; c < C; ++c) {
        const float *of_x = octave_.coarse->row(m / 2, C * M::kX + c),
                    *of_y = octave_.coarse->row(m / 2, C * M::kY + c);
        float* to = estimate_[c];
        for (int x = kReach; x < width_ - kReach; ++x) {
          const int i = first_ + x;
          to[x] += (i % 2 == 0 ? -unit_ : unit_) * of_x[i / 2] + above * of_y[i / 2];
        }
      }
    }
  }

  void write_estimates(int m) {
    for (int i = 0; i < O::kCount; ++i)
      std::copy_n(estimate_[i] + kReach, x1_ - x0_, octave_.window_estimates->row(m, i) + x0_);
  }

  bool first_lattice() const { return octave_.shift == 0; }
  bool last_lattice() const { return octave_.shift == task_.settings->lattices - 1; }

  void write_pixels(int m) {
    for (int g = 0; g < groups(); ++g) {
      read_features(task_.samples->estimated_features(), nullptr, m, g);
      for (int k = 0; k < kGroup; ++k) {
        const int y = pixel_row(m, g, k);
        if (y >= 0 && y < task_.height()) write_pixels(y, g, k);
      }
    }
  }

  Lanes estimate_of(int g, int k, int c, int x) const {
    Lanes sum{};
    for (int i = 0; i < P; ++i) sum += load(estimate_[C * i + c] + x) * feature(i, g, k, x);
    return sum;
  }

  // Adds this lattice's estimates to pixel row y. After the last lattice, divides the sums by their total weight.
  void write_pixels(int y, int g, int k) {
    std::array<float*, C + 2> rows{};
    for (int c = 0; c < C; ++c) rows[size_t(c)] = task_.results[size_t(c) / 3]->row(y, c % 3);
    rows[C] = task_.totals->row(y);
    rows[C + 1] = Estimates ? task_.bias->row(y) : nullptr;
    const int dx = pixel_x(g, k), planes = Estimates ? C + 2 : C + 1;
    // The blocks within reach belong to other tiles, whose threads may be writing them.
    for (int i = 0; i < planes; ++i) pick(first_lattice() ? nullptr : rows[size_t(i)], dx, boxes_[i], kReach);
    for (int x = 0; x < width_; x += kLanes) {
      for (int c = 0; c < C; ++c) {
        store(load(boxes_[c] + x) + estimate_of(g, k, c, x), boxes_[c] + x);
      }
      for (int i = 0; i < planes - C; ++i)
        store(load(boxes_[C + i] + x) + load(estimate_[O::kConfidence + i] + x), boxes_[C + i] + x);
    }
    if (last_lattice()) add_own(y, dx);
    for (int i = 0; i < planes; ++i) put(boxes_[i], dx, rows[size_t(i)]);
  }

  // x = (E + own I)/(T + own), where T is the sum of η and E that of η times the estimates.
  void add_own(int y, int dx) {
    const bool counts = task_.samples->own_weights != nullptr;
    float *own = moments_[0], *sampled = moments_[1];
    pick(counts ? task_.samples->own_weights->row(y) : nullptr, dx, own);
    const auto divide = [&](int plane, const auto& numerator) {
      const Lanes zero{};
      for (int x = 0; x < width_; x += kLanes) {
        const Lanes total = load(boxes_[C] + x) + load(own + x);
        store(total > zero ? numerator(x) / total : zero, boxes_[plane] + x);
      }
    };
    for (int c = 0; c < C; ++c) {
      pick(counts && (Estimates || !GRADUS_FAULT(alpha_lacks_own_values)) ? own_value_row(y, c) : nullptr, dx, sampled);
      divide(c, [&](int x) { return load(boxes_[c] + x) + load(own + x) * load(sampled + x); });
    }
    if constexpr (Estimates) divide(C + 1, [&](int x) { return load(boxes_[C + 1] + x); });
  }

  void put(const float* from, int dx, float* row) const {
    row += first_ * side_ + dx - octave_.shift;
    const int begin = std::max(kReach, first_inside(dx)), end = std::min(width_ - kReach, end_inside(dx));
    const ptrdiff_t side = side_;
    for (int x = begin; x < end; ++x) row[side * x] = from[x];
  }

  const RegressionTask& task_;
  const OctaveTask<Estimates>& octave_;
  const int side_, x0_, x1_, y0_, y1_, first_, width_;
  const float unit_;
  Rows pixels_, moments_, boxes_;
  std::array<Rows, 2> pairs_;
  std::array<Rows, 3> quads_;
  Rows estimate_;
  std::array<Rows, 3> small_, large_;
  std::array<Rows, 2> columns_;
};

}  // namespace gradus::reconstruct
