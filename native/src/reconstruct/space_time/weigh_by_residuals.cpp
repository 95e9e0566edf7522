#include "reconstruct/space_time/weigh_by_residuals.h"

#include "reconstruct/poisson/l1_weights.h"
#include "reconstruct/space_time/correspondence_rows.h"
#include "reconstruct/space_time/value_rows.h"

namespace gradus::reconstruct {
namespace {

// A value, and its differences to the right and up.
struct RowTriple {
  RowKind value, right, up;
};

struct SquaredResiduals {
  explicit SquaredResiduals(int width) : value(width), right(width), up(width) {}
  std::vector<float> value, right, up;
};

// Σ e² over the channels for row y: residuals of v, of which the rows y and y + 1 are there.
class Residuals {
 public:
  Residuals(const WindowSource& source, const RowTriple& kinds, int t, int channels)
      : source_(source),
        kinds_(kinds),
        t_(t),
        channels_(channels),
        value_(source.size(), 0, channels),
        right_(value_),
        up_(value_) {}

  void read(int y, RollingRows* v, SquaredResiduals* out) {
    value_.load(source_, kinds_.value, t_, y);
    right_.load(source_, kinds_.right, t_, y);
    up_.load(source_, kinds_.up, t_, y);
    for (auto* sums : {&out->value, &out->right, &out->up}) std::fill(sums->begin(), sums->end(), 0.0f);
    for (int c = 0; c < channels_; ++c) {
      const float *here = v->row(y, c), *above = v->row(y + 1, c);
      const float *value = value_.channel(c), *right = right_.channel(c), *up = up_.channel(c);
      for (size_t x = 0; x < out->value.size(); ++x) {
        const float e = here[x] - value[x], ex = here[x + 1] - here[x] - right[x], ey = above[x] - here[x] - up[x];
        out->value[x] += e * e;
        out->right[x] += ex * ex;
        out->up[x] += ey * ey;
      }
    }
  }

 private:
  const WindowSource& source_;
  RowTriple kinds_;
  int t_, channels_;
  ValueRow value_, right_, up_;
};

// fill(y, &rows): as of for_product_rows().
template <class Fill>
void weigh(const WindowSource& source, const RowTriple& kinds, int t, int channels, const RowNorm& of_values,
           const RowNorm& of_differences, const Fill& fill, SpaceTimeSystem* system) {
  const int w = system->width(), h = system->height();
  for_pieces(h, [&](int begin, int end) {
    RollingRows v(w, channels);
    Residuals residuals(source, kinds, t, channels);
    SquaredResiduals weights(w);
    const auto make = [&](int y) {
      for (int c = 0; c < channels; ++c) std::fill_n(v.row(y, c), w, 0.0f);
      if (y < h) fill(y, &v);
    };
    make(begin);
    for (int y = begin; y < end; ++y) {
      make(y + 1);
      residuals.read(y, &v, &weights);
      for (float& value : weights.value) value = of_values.weight(value);
      for (float& value : weights.right) value = of_differences.weight(value);
      for (float& value : weights.up) value = of_differences.weight(value);
      system->set_weights(kinds.value, t, y, weights.value.data());
      system->set_weights(kinds.right, t, y, weights.right.data());
      system->set_weights(kinds.up, t, y, weights.up.data());
    }
  });
}

}  // namespace

void weigh_by_residuals(const WindowSource& source, const Frames& x, float alpha, float scale, float floor,
                        SpaceTimeSystem* system) {
  const int w = system->width(), channels = x.front().channels();
  const RowNorm norm = row_norm(channels, scale, floor);
  for (int t = 0; t < system->frames(); ++t) {
    system->frame(t).factor = alpha * alpha;
    const Field& frame = x[size_t(t)];
    const auto copy = [&](int y, RollingRows* rows) {
      for (int c = 0; c < channels; ++c) std::copy_n(frame.row(y, c), w, rows->row(y, c));
    };
    weigh(source, {RowKind::kPrimal, RowKind::kDx, RowKind::kDy}, t, channels, norm.of_pixels(alpha), norm, copy,
          system);
  }
  for (int t = 0; t + 1 < system->frames(); ++t) {
    const auto subtract = [&](int y, RollingRows* rows) {
      subtract_row(system->correspondence(t), y, x[size_t(t)], x[size_t(t) + 1], rows);
    };
    weigh(source, {RowKind::kDt, RowKind::kDxDt, RowKind::kDyDt}, t, channels, norm, norm, subtract, system);
  }
}

}  // namespace gradus::reconstruct
