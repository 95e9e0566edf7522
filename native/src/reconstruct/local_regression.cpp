#include "reconstruct/local_regression.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/fpu.h"
#include "reconstruct/window_solve.h"

namespace gradus {
namespace {

// Outputs of a tile. Its sums are in the second cache; the taller, the less is done twice.
constexpr int kTileWidth = 80, kTileHeight = 128;
// Windows of this radius and above are taken around every other row.
constexpr int kSparseRadius = 4;
// Pixels in a unit of the coordinates: some windows, so that their slopes feel the ridge as little as those of the other features do.
constexpr float kCoordinateUnit = 20.0f;

// Rows of floats: planes of one image row, or of some.
class Rows {
 public:
  Rows(int count, int width) : width_((size_t(width) + 2 * kLanes - 1) / kLanes * kLanes), values_(width_ * size_t(count)) {}
  float* operator[](int i) { return values_.data() + width_ * size_t(i); }
  const float* operator[](int i) const { return values_.data() + width_ * size_t(i); }
  size_t width() const { return width_; }

 private:
  size_t width_;  // room for whole lanes behind the last
  std::vector<float> values_;
};

Lanes load(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
void store(const Lanes& lanes, float* to) { std::memcpy(to, &lanes, sizeof(lanes)); }

// What a tile reads and writes. `values` have C channels: three means and three half differences when η is estimated, else one.
struct Task {
  const Field *features, *weights, *own, *values;
  const RegressionSettings* settings;
  const Field* confidence;  // where it is known already
  Field *new_confidence, *result, *bias;
};

// The windows of one tile, row by row, for a constant and B − 1 features, with or without the pixel's coordinates, and C right sides. With
// `Estimates` the first half of the sides are means, the second half differences.
//
// Coordinates count from the window's centre while it is solved for: from anywhere else, floats would not hold the constant of a window
// with steep slopes.
template <int B, bool Coordinates, int C, bool Estimates>
class Tile {
 public:
  Tile(const Task& task, int x0, int x1, int y0, int y1)
      : task_(task),
        x0_(x0),
        x1_(x1),
        y0_(y0),
        y1_(y1),
        reach_(task.settings->radii.back()),
        first_(x0 - 2 * reach_),
        width_(x1 - x0 + 4 * reach_),
        moments_(kMoments * (2 * reach_ + 1), width_),
        columns_(kColumns, width_),
        boxes_(kBoxes, width_),
        said_(kSaid * int(task.settings->radii.size()), width_),
        sums_(kSaid * (2 * reach_ + 1), width_),
        basis_(P, width_) {}

  void run() {
    for (int y = y0_ - 2 * reach_; y < y0_; ++y) read_moments(y);
    for (int q = y0_ - reach_; q < y1_ + reach_; ++q) {
      read_moments(q + reach_);
      if (q >= 0 && q < task_.weights->height()) regress_row(q);
      if (q - reach_ >= y0_) write_row(q - reach_);
    }
  }

 private:
  // φ: constant, features, x, y.
  static constexpr int P = B + (Coordinates ? 2 : 0), kX = B, kY = B + 1;
  // Moments of a pixel's row: products of features, those with the right sides, and w (v² − d²) over the channels.
  static constexpr int kRight = packed(B, 0), kSquares = kRight + B * C, kMoments = kSquares + 1;
  // Sums over columns: the moments; those with y: of the features, of the right sides, and y².
  static constexpr int kRamps = kMoments, kColumns = kMoments + (Coordinates ? B + C + 1 : 0);
  // Sums over windows: normal equations, and the squares.
  static constexpr int kBoxRight = packed(P, 0), kBoxSquares = kBoxRight + P * C, kBoxes = kBoxSquares + 1;
  // What windows say: coefficients times η, η, bias times η.
  static constexpr int kSides = P * C, kConfidence = kSides, kBias = kSides + 1, kSaid = kSides + 2;

  int slot(int y, int planes) const { return planes * ((y + 4 * reach_ + 2) % (2 * reach_ + 1)); }
  // A pixel's coordinates in its tile.
  float tile_x(int x) const { return float(x - width_ / 2) / kCoordinateUnit; }
  float tile_y(int y) const { return float(y - (y0_ + y1_) / 2) / kCoordinateUnit; }

  // φ of row y.
  void read_basis(int y) {
    const int begin = std::max(first_, 0), end = std::min(first_ + width_, task_.weights->width());
    std::fill_n(basis_[0], width_, 1.0f);
    for (int c = 0; c + 1 < B; ++c) std::copy_n(task_.features->row(y, c) + begin, end - begin, basis_[1 + c] + (begin - first_));
    if constexpr (Coordinates) {
      for (int x = 0; x < width_; ++x) basis_[kX][x] = tile_x(x);
      std::fill_n(basis_[kY], width_, tile_y(y));
    }
  }

  // The moments of row y take the place of those of the row 2·reach + 1 below.
  void read_moments(int y) {
    const int at = slot(y, kMoments);
    for (int i = 0; i < kMoments; ++i) std::fill_n(moments_[at + i], moments_.width(), 0.0f);
    if (y < 0 || y >= task_.weights->height()) return;
    read_basis(y);
    const int begin = std::max(first_, 0), end = std::min(first_ + width_, task_.weights->width()), shift = begin - first_;
    const float* w = task_.weights->row(y) + begin;
    const int n = end - begin;
    for (int i = 0; i < B; ++i) {
      const float* a = basis_[i] + shift;
      for (int j = 0; j <= i; ++j) multiply(w, a, basis_[j] + shift, n, moments_[at + packed(i, j)] + shift);
      for (int c = 0; c < C; ++c) multiply(w, a, task_.values->row(y, c) + begin, n, moments_[at + kRight + C * i + c] + shift);
    }
    float* squares = moments_[at + kSquares] + shift;
    for (int c = 0; c < C; ++c) {
      const float *v = task_.values->row(y, c) + begin, sign = !Estimates || c < C / 2 ? 1.0f : -1.0f;
      for (int x = 0; x < n; ++x) squares[x] += sign * w[x] * v[x] * v[x];
    }
  }

  static void multiply(const float* w, const float* a, const float* b, int n, float* to) {
    for (int x = 0; x < n; ++x) to[x] = w[x] * a[x] * b[x];
  }

  // All windows around the pixels of row q.
  void regress_row(int q) {
    const std::vector<int>& radii = task_.settings->radii;
    int done = -1;
    for (int k = 0; k < int(radii.size()); ++k) {
      if (!has_windows(q, radii[size_t(k)])) continue;
      for (; done < radii[size_t(k)]; ++done) add_rows(q, done + 1);
      sum_windows(radii[size_t(k)]);
      for (int x = reach_; x < width_ - reach_; x += kLanes) regress(q, k, radii[size_t(k)], x);
    }
    spread(q);
  }

  // Large windows overlap so much that every other row of them does.
  static int row_step(int r) { return r < kSparseRadius ? 1 : 2; }
  static bool has_windows(int q, int r) { return q % row_step(r) == 0; }

  // Adds the moments of the rows q ± r to the columns' sums.
  void add_rows(int q, int r) {
    const int above = slot(q + r, kMoments), below = slot(q - r, kMoments);
    for (int i = 0; i < kMoments; ++i) {
      if (r == 0) {
        std::copy_n(moments_[above + i], width_, columns_[i]);
      } else {
        add(moments_[above + i], moments_[below + i], 1.0f, 1.0f, columns_[i]);
      }
    }
    if constexpr (Coordinates) {
      const float y = float(r) / kCoordinateUnit;
      if (r == 0) return std::fill(columns_[kRamps], columns_[kColumns - 1] + width_, 0.0f);
      for (int i = 0; i < B; ++i) add(moments_[above + packed(i, 0)], moments_[below + packed(i, 0)], y, -y, columns_[kRamps + i]);
      for (int c = 0; c < C; ++c) add(moments_[above + kRight + c], moments_[below + kRight + c], y, -y, columns_[kRamps + B + c]);
      add(moments_[above], moments_[below], y * y, y * y, columns_[kRamps + B + C]);
    }
  }

  void add(const float* a, const float* b, float of_a, float of_b, float* to) const {
    for (int x = 0; x < width_; ++x) to[x] += of_a * a[x] + of_b * b[x];
  }

  void sum_windows(int r) {
    for (int i = 0; i < packed(B, 0); ++i) box(columns_[i], r, boxes_[i]);
    for (int i = 0; i < B * C; ++i) box(columns_[kRight + i], r, boxes_[kBoxRight + i]);
    box(columns_[kSquares], r, boxes_[kBoxSquares]);
    if constexpr (Coordinates) {
      for (int j = 0; j < B; ++j) {
        ramp(columns_[packed(j, 0)], r, boxes_[packed(kX, j)]);
        box(columns_[kRamps + j], r, boxes_[packed(kY, j)]);
      }
      square_ramp(columns_[0], r, boxes_[packed(kX, kX)]);
      ramp(columns_[kRamps], r, boxes_[packed(kY, kX)]);
      box(columns_[kRamps + B + C], r, boxes_[packed(kY, kY)]);
      for (int c = 0; c < C; ++c) {
        ramp(columns_[kRight + c], r, boxes_[kBoxRight + C * kX + c]);
        box(columns_[kRamps + B + c], r, boxes_[kBoxRight + C * kY + c]);
      }
    }
  }

  // Sums over 2r + 1 values; those times x from the middle; those times x². One pass over the row for each radius in use.
  void box(const float* from, int r, float* to) const {
    switch (r) {
      case 1:
        return weighted_box<1>(from, to, [](int) { return 1.0f; });
      case 2:
        return weighted_box<2>(from, to, [](int) { return 1.0f; });
      case 4:
        return weighted_box<4>(from, to, [](int) { return 1.0f; });
      default:
        return weighted_box<8>(from, to, [](int) { return 1.0f; });
    }
  }
  void ramp(const float* from, int r, float* to) const {
    constexpr auto weight = [](int d) { return float(d) / kCoordinateUnit; };
    r == 1 ? weighted_box<1>(from, to, weight) : r == 2 ? weighted_box<2>(from, to, weight) : weighted_box<4>(from, to, weight);
  }
  void square_ramp(const float* from, int r, float* to) const {
    constexpr auto weight = [](int d) { return float(d * d) / (kCoordinateUnit * kCoordinateUnit); };
    r == 1 ? weighted_box<1>(from, to, weight) : r == 2 ? weighted_box<2>(from, to, weight) : weighted_box<4>(from, to, weight);
  }
  template <int R, class Weight>
  void weighted_box(const float* from, float* to, const Weight& weight) const {
    for (int x = R; x < width_ - R; ++x) {
      float sum = weight(0) * from[x];
      for (int d = 1; d <= R; ++d) sum += weight(d) * from[x + d] + weight(-d) * from[x - d];
      to[x] = sum;
    }
  }

  // Eight windows: coefficients, error and, by these, what they have to say.
  void regress(int q, int scale, int r, int x) {
    const int said = scale * kSaid;
    Lanes matrix[packed(P, 0)], right[kSides], solution[kSides];
    for (int i = 0; i < packed(P, 0); ++i) matrix[i] = load(boxes_[i] + x);
    for (int i = 0; i < kSides; ++i) solution[i] = right[i] = load(boxes_[kBoxRight + i] + x);
    const Lanes zero{}, weight = matrix[0], ridge = task_.settings->ridge * weight;
    for (int i = 1; i < P; ++i) matrix[packed(i, i)] += ridge;
    solve_windows<P, C>(matrix, solution);
    Lanes eta, bias = zero;
    if constexpr (Estimates) {
      Lanes residual = load(boxes_[kBoxSquares] + x), noise = zero;
      for (int i = 0; i < P; ++i) {
        for (int c = 0; c < C / 2; ++c) {
          const Lanes v = solution[C * i + c], d = solution[C * i + C / 2 + c], penalty = i == 0 ? zero : ridge;
          const Lanes of_noise = d * right[C * i + C / 2 + c];
          residual += of_noise + penalty * d * d - v * (right[C * i + c] + penalty * v);
          noise += of_noise - penalty * d * d;
        }
      }
      const Lanes unit = weight > zero ? 1.0f / (float(C / 2) * weight) : zero;
      bias = residual > zero ? unit * residual : zero;
      const Lanes error = bias + (noise > zero ? unit * noise : zero) + task_.settings->floor;
      eta = weight > zero ? float(row_step(r)) / (float((2 * r + 1) * (2 * r + 1)) * error) : zero;
      store(eta, said_[said + kConfidence] + x);
      keep_confidence(q, scale, x);
    } else {
      load_confidence(q, scale, x);
      eta = load(said_[said + kConfidence] + x);
    }
    if constexpr (Coordinates) {
      const Lanes at_x = load(basis_x() + x), at_y = zero + tile_y(q);
      for (int c = 0; c < C; ++c) solution[c] -= at_x * solution[C * kX + c] + at_y * solution[C * kY + c];
    }
    for (int i = 0; i < kSides; ++i) store(eta * solution[i], said_[said + i] + x);
    store(eta * bias, said_[said + kBias] + x);
  }

  const float* basis_x() const { return basis_[kX]; }

  // η of the tile's own pixels is kept: those beside it are another tile's.
  void keep_confidence(int q, int scale, int x) {
    if (q < y0_ || q >= y1_) return;
    for (int i = std::max(x, 2 * reach_); i < std::min(x + kLanes, width_ - 2 * reach_); ++i)
      task_.new_confidence->row(q, scale)[first_ + i] = said_[scale * kSaid + kConfidence][i];
  }
  void load_confidence(int q, int scale, int x) {
    for (int i = x; i < x + kLanes; ++i) {
      const int at = first_ + i;
      said_[scale * kSaid + kConfidence][i] = at >= 0 && at < task_.weights->width() ? task_.confidence->row(q, scale)[at] : 0.0f;
    }
  }

  // What the windows of row q say, to the pixels that they hold: the largest first, so that each row takes the sum of what reaches it.
  // There are no windows around pixels outside of the image.
  void spread(int q) {
    const std::vector<int>& radii = task_.settings->radii;
    const int begin = std::max(std::max(first_, 0) - first_, reach_);
    const int end = std::min(std::min(first_ + width_, task_.weights->width()) - first_, width_ - reach_);
    float *sum = boxes_[0], *part = boxes_[1];
    for (int i = 0; i < kSaid; ++i) {
      std::fill_n(sum, width_, 0.0f);
      for (size_t k = radii.size(); k-- > 0;) {
        const int r = radii[k], inner = k > 0 ? radii[k - 1] : -1;
        if (has_windows(q, r)) {
          float* said = said_[int(k) * kSaid + i];
          std::fill_n(said, begin, 0.0f);
          std::fill(said + end, said + said_.width(), 0.0f);
          box(said, r, part);
          for (int x = 2 * reach_; x < width_ - 2 * reach_; ++x) sum[x] += part[x];
        }
        for (int d = r; d > inner; --d) {
          give(sum, q + d, i);
          if (d > 0) give(sum, q - d, i);
        }
      }
    }
  }

  void give(const float* sum, int y, int i) {
    if (y < y0_ || y >= y1_) return;
    float* to = sums_[slot(y, kSaid) + i];
    for (int x = 2 * reach_; x < width_ - 2 * reach_; ++x) to[x] += sum[x];
  }

  void write_row(int y) {
    read_basis(y);
    const int at = slot(y, kSaid), begin = x0_ - first_, n = x1_ - x0_;
    const float* all = sums_[at + kConfidence] + begin;
    const float* own = task_.own->row(y) + x0_;
    for (int c = 0; c < C; ++c) {
      float* to = task_.result->row(y, c) + x0_;
      const float* value = task_.values->row(y, c) + x0_;
      for (int x = 0; x < n; ++x) {
        float sum = 0.0f;
        for (int i = 0; i < P; ++i) sum += sums_[at + C * i + c][begin + x] * basis_[i][begin + x];
        const float total = all[x] + own[x];
        to[x] = total > 0.0f ? (sum + own[x] * value[x]) / total : 0.0f;
      }
    }
    if constexpr (Estimates) {
      const float* bias = sums_[at + kBias] + begin;
      for (int x = 0; x < n; ++x) task_.bias->row(y)[x0_ + x] = all[x] > 0.0f ? bias[x] / (all[x] + own[x]) : 0.0f;
    }
    for (int i = 0; i < kSaid; ++i) std::fill_n(sums_[at + i], sums_.width(), 0.0f);
  }

  const Task& task_;
  const int x0_, x1_, y0_, y1_, reach_, first_, width_;
  Rows moments_, columns_, boxes_, said_, sums_, basis_;
};

template <int B, bool Coordinates, int C, bool Estimates>
void run_tiles(const Task& task, const CancelTest& cancel) {
  const int w = task.weights->width(), h = task.weights->height();
  tbb::parallel_for(tbb::blocked_range2d<int>(0, (h + kTileHeight - 1) / kTileHeight, 1, 0, (w + kTileWidth - 1) / kTileWidth, 1),
                    [&](const tbb::blocked_range2d<int>& range) {
                      const FlushDenormals flush;
                      for (int j = range.rows().begin(); j < range.rows().end(); ++j) {
                        for (int i = range.cols().begin(); i < range.cols().end() && !cancel(); ++i) {
                          Tile<B, Coordinates, C, Estimates>(task, i * kTileWidth, std::min(w, (i + 1) * kTileWidth), j * kTileHeight,
                                                             std::min(h, (j + 1) * kTileHeight))
                              .run();
                        }
                      }
                    });
}

template <int C, bool Estimates>
void run_features(const Task& task, const CancelTest& cancel) {
  const int features = task.features->channels();
  const bool coordinates = task.settings->coordinates;
  if (features == 7 && coordinates) return run_tiles<8, true, C, Estimates>(task, cancel);
  if (features == 3 && !coordinates) return run_tiles<4, false, C, Estimates>(task, cancel);
  throw unsupported("regression on so many features");
}

}  // namespace

LocalRegression::LocalRegression(Field features, Field weights, Field own, RegressionSettings settings)
    : features_(std::move(features)),
      weights_(std::move(weights)),
      own_(std::move(own)),
      settings_(std::move(settings)),
      confidence_(weights_.width(), weights_.height(), int(settings_.radii.size())) {}

RegressionResult LocalRegression::estimate(const Field& mean, const Field& half_difference, const CancelTest& cancel) {
  const int w = mean.width(), h = mean.height();
  Field both(w, h, 6), fits(w, h, 6);
  for (int y = 0; y < h; ++y) {
    for (int c = 0; c < 3; ++c) {
      std::copy_n(mean.row(y, c), w, both.row(y, c));
      std::copy_n(half_difference.row(y, c), w, both.row(y, 3 + c));
    }
  }
  RegressionResult result{Field(w, h, 3), Field(w, h, 3), Field(w, h, 1)};
  run_features<6, true>({&features_, &weights_, &own_, &both, &settings_, nullptr, &confidence_, &fits, &result.bias}, cancel);
  for (int y = 0; y < h; ++y) {
    for (int c = 0; c < 3; ++c) {
      std::copy_n(fits.row(y, c), w, result.mean.row(y, c));
      std::copy_n(fits.row(y, 3 + c), w, result.noise.row(y, c));
    }
  }
  return result;
}

Field LocalRegression::apply(const Field& values, const CancelTest& cancel) const {
  Field result(values.width(), values.height(), 1);
  run_features<1, false>({&features_, &weights_, &own_, &values, &settings_, &confidence_, nullptr, &result, nullptr}, cancel);
  return result;
}

}  // namespace gradus
