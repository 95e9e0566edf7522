#include "reconstruct/poisson/red_black.h"

#include <algorithm>
#include <memory>

namespace gradus::reconstruct {
namespace {

enum class Color { kRed, kBlack };

// A window of rows of x that a pass moves up the grid. Each row is split into the pixels of even and of odd x, so that
// pixels of one colour lie next to each other in memory.
class CheckeredRows {
 public:
  CheckeredRows(const Stencil& a, const Field& b)
      : a_(a),
        b_(b),
        length_((a.width() + 1) / 2),
        planes_(kWeights + 4 * size_t(b.channels())),
        stride_(size_t(length_) + 2 * kPad),
        halves_(new float[kRows * planes_ * stride_]) {
    for (int y = 0; y < kRows; ++y) {
      for (size_t plane = 0; plane < planes_; ++plane) {
        std::fill_n(half(y, plane) - kPad, kPad, 0.0f);
        std::fill_n(half(y, plane) + length_, kPad, 0.0f);
      }
    }
  }

  // Loads row y; rows must come in order. Rows beyond the grid are 0. Red pixels get the result of half a sweep from 0.
  void load(int y);
  // Solves the equations of all pixels of one colour in a row, given the values of the other colour around them.
  void relax(int y, Color color);
  // Replaces the red values of a row by the residuals of their equations. Once the black pixels are solved, all other
  // residuals are 0.
  void leave_residual(int y);

  float* values(int y, Color color, int channel) { return values_of(y, side(y, color), channel); }
  // Writes row y of one channel with both colours interleaved. Writes an even number of values: for an odd width, the
  // last one goes to the rim and is 0.
  void join(int y, int channel, float* row);

 private:
  static constexpr int kRows = 6;
  static constexpr size_t kPad = 8, kWeights = 6;

  // Weights and values of the other colour around the pixels of one parity in a row.
  struct Neighbours {
    const float *weight[4], *value[4];
    float sum(ptrdiff_t i) const {
      return weight[0][i] * value[0][i] + weight[1][i] * value[1][i] + weight[2][i] * value[2][i] +
             weight[3][i] * value[3][i];
    }
  };
  Neighbours neighbours(int y, int side, int channel);

  // Returns which pixels of row y have the colour: 0 for those of even x, 1 for odd x.
  static int side(int y, Color color) { return (y & 1) ^ int(color); }
  float* half(int y, size_t plane) {
    return halves_.get() + kPad + stride_ * (size_t((y + kRows) % kRows) * planes_ + plane);
  }
  float* inverse(int y, int side) { return half(y, size_t(side)); }
  float* right(int y, int side) { return half(y, 2 + size_t(side)); }
  float* up(int y, int side) { return half(y, 4 + size_t(side)); }
  float* target(int y, int side, int channel) { return half(y, kWeights + 4 * size_t(channel) + size_t(side)); }
  float* values_of(int y, int side, int channel) { return half(y, kWeights + 4 * size_t(channel) + 2 + size_t(side)); }
  void split(const float* row, float* even, float* odd) const;

  const Stencil& a_;
  const Field& b_;
  int length_;
  size_t planes_, stride_;
  std::unique_ptr<float[]> halves_;
};

void CheckeredRows::split(const float* row, float* even, float* odd) const {
  for (ptrdiff_t i = 0; i < length_; ++i) {
    even[i] = row[2 * i];
    odd[i] = row[2 * i + 1];
  }
}

void CheckeredRows::load(int y) {
  if (y < 0 || y >= a_.height()) return static_cast<void>(std::fill_n(half(y, 0) - kPad, planes_ * stride_, 0.0f));
  split(a_.diagonal.row(y), inverse(y, 0), inverse(y, 1));
  for (int s = 0; s < 2; ++s) {
    float* inverses = inverse(y, s);
    for (int i = 0; i < length_; ++i) inverses[i] = inverse_or_zero(inverses[i]);
  }
  split(a_.right.row(y), right(y, 0), right(y, 1));
  split(a_.up.row(y), up(y, 0), up(y, 1));
  const int red = side(y, Color::kRed);
  for (int c = 0; c < b_.channels(); ++c) {
    split(b_.row(y, c), target(y, 0, c), target(y, 1, c));
    const float *s = inverse(y, red), *b = target(y, red, c);
    float* x = values_of(y, red, c);
    for (int i = 0; i < length_; ++i) x[i] = s[i] * b[i];
  }
}

CheckeredRows::Neighbours CheckeredRows::neighbours(int y, int side, int channel) {
  const float* beside = values_of(y, 1 - side, channel);
  // Pixels of even x have the odd pixel of the same index to their right; those of odd x have the even pixel of the
  // same index to their left.
  const ptrdiff_t beyond = side == 0 ? -1 : 1, weight_beyond = side == 0 ? -1 : 0;
  return {{right(y, 0), right(y, 1) + weight_beyond, up(y, side), up(y - 1, side)},
          {beside, beside + beyond, values_of(y + 1, side, channel), values_of(y - 1, side, channel)}};
}

void CheckeredRows::relax(int y, Color color) {
  const int at = side(y, color);
  for (int c = 0; c < b_.channels(); ++c) {
    const Neighbours around = neighbours(y, at, c);
    const float *s = inverse(y, at), *b = target(y, at, c);
    float* x = values_of(y, at, c);
    for (int i = 0; i < length_; ++i) x[i] = s[i] * (b[i] + around.sum(i));
  }
}

void CheckeredRows::leave_residual(int y) {
  const int at = side(y, Color::kRed);
  for (int c = 0; c < b_.channels(); ++c) {
    const Neighbours around = neighbours(y, at, c);
    float* x = values_of(y, at, c);
    for (int i = 0; i < length_; ++i) x[i] = around.sum(i);
  }
}

void CheckeredRows::join(int y, int channel, float* row) {
  const float *even = values_of(y, 0, channel), *odd = values_of(y, 1, channel);
  for (ptrdiff_t i = 0; i < length_; ++i) {
    row[2 * i] = even[i];
    row[2 * i + 1] = odd[i];
  }
}

}  // namespace

void restrict_after_sweep(const Stencil& a, const Interpolation& p, const Field& b, Field* coarse) {
  for_pieces(
      coarse->height(),
      [&](int begin, int end) {
        CheckeredRows rows(a, b);
        for (int y = 2 * begin - 3; y <= 2 * end + 1; ++y) {
          rows.load(y);
          if (y > 2 * begin - 2) rows.relax(y - 1, Color::kBlack);
          if (y > 2 * begin) rows.leave_residual(y - 2);
          if (y < 2 * begin + 3 || y % 2 == 0) continue;
          const int coarse_y = (y - 3) / 2;
          for (int c = 0; c < b.channels(); ++c) {
            p.restrict_red_rows(coarse_y, rows.values(y - 4, Color::kRed, c), rows.values(y - 3, Color::kRed, c),
                                rows.values(y - 2, Color::kRed, c), coarse->row(coarse_y, c));
          }
        }
      },
      kGrainOfStencils / 2);
}

RowSums sweep_interpolated(const Stencil& a, const Interpolation& p, const Field& b, const Field& coarse, Field* z) {
  RowSums sums(a.height(), b.channels());
  for_pieces(
      a.height(),
      [&](int begin, int end) {
        CheckeredRows rows(a, b);
        for (int y = begin - 2; y < end + 2; ++y) {
          rows.load(y);
          for (int c = 0; c < b.channels() && y >= 0 && y < a.height(); ++c) {
            p.add_to_red_row(y, coarse.row(y / 2, c), coarse.row(y / 2 + 1, c), rows.values(y, Color::kRed, c));
          }
          if (y > begin - 1) rows.relax(y - 1, Color::kBlack);
          if (y < begin + 2) continue;
          rows.relax(y - 2, Color::kRed);
          for (int c = 0; c < b.channels(); ++c) {
            rows.join(y - 2, c, z->row(y - 2, c));
            sums.at(y - 2, c) = dot_row(z->row(y - 2, c), b.row(y - 2, c), a.width());
          }
        }
      },
      kGrainOfStencils);
  return sums;
}

}  // namespace gradus::reconstruct
