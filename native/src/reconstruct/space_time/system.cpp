#include "reconstruct/space_time/system.h"

#include "base/types.h"
#include "reconstruct/space_time/linked_rows.h"

namespace gradus {
namespace {

std::vector<Links> read_all_links(const WindowSource& source) {
  const WindowSize size = source.size();
  std::vector<Links> result;
  std::vector<int32_t> row(static_cast<size_t>(size.width));
  for (int t = 0; t + 1 < size.frames; ++t) {
    Links& links = result.emplace_back(size.width, size.height);
    std::vector<bool> taken(size_t(size.width) * size_t(size.height), false);
    for (int y = 0; y < size.height; ++y) {
      source.read_links(t, y, row.data());
      links.set_row(y, row.data(), &taken);
    }
  }
  return result;
}

// Channels of the values of one kind of rows, one after another, for a right side. What is missing has weight 0; any number would do.
class ValueRow {
 public:
  ValueRow(const WindowSize& size, int first_channel, int channels)
      : size_(size),
        first_(first_channel),
        values_(size_t(size.width) * size_t(channels)),
        read_(size_t(size.width) * size_t(size.channels)) {}

  void load(const WindowSource& source, RowKind kind, int t, int y) {
    if (y < 0) return static_cast<void>(std::fill(values_.begin(), values_.end(), 0.0f));
    source.read_row(kind, t, y, read_.data());
    const size_t w = size_t(size_.width), channels = values_.size() / w, stride = size_t(size_.channels);
    for (size_t c = 0; c < channels; ++c) {
      const float* from = read_.data() + size_t(first_) + c;
      for (size_t x = 0; x < w; ++x, from += stride) values_[c * w + x] = is_finite(*from) ? *from : 0.0f;
    }
  }
  const float* channel(int c) const { return values_.data() + size_t(c) * size_t(size_.width); }
  void swap(ValueRow& other) { values_.swap(other.values_); }

 private:
  WindowSize size_;
  int first_;
  std::vector<float> values_, read_;
};

// Calls use(y, channel, row) with the rows of W_s v + Dᵀ W_g g, of three kinds of rows.
template <class Use>
void for_right_side(const ScreenedLaplacian& weights, const WindowSource& source, const RowKind (&kinds)[3], int t, int first, int channels,
                    const Use& use) {
  const int w = weights.width();
  for_pieces(weights.height(), [&](int begin, int end) {
    ValueRow value(source.size(), first, channels), right(value), up(value), down(value);
    LaplacianRow row(w);
    std::vector<float> out(static_cast<size_t>(w));
    up.load(source, kinds[2], t, begin - 1);
    for (int y = begin; y < end; ++y) {
      down.swap(up);
      value.load(source, kinds[0], t, y);
      right.load(source, kinds[1], t, y);
      up.load(source, kinds[2], t, y);
      row.load(weights, y);
      for (int c = 0; c < channels; ++c) {
        const float *v = value.channel(c), *gx = right.channel(c), *gy = up.channel(c), *below = down.channel(c);
        float flux = 0.0f;
        for (int x = 0; x < w; ++x) {
          const float next_flux = row.right()[x] * gx[x];
          out[x] = row.screen()[x] * v[x] + flux - next_flux + row.down()[x] * below[x] - row.up()[x] * gy[x];
          flux = next_flux;
        }
        use(y, c, out.data());
      }
    }
  });
}

void add(Sums* sums, const RowSums& rows) {
  const Sums more = rows.total();
  for (size_t c = 0; c < more.size(); ++c) (*sums)[c] += more[c];
}

}  // namespace

SpaceTimeSystem::SpaceTimeSystem(const WindowSource& source)
    : frames_(size_t(source.size().frames), ScreenedLaplacian(source.size().width, source.size().height)),
      couplings_(frames_.begin() + 1, frames_.end()),
      links_(read_all_links(source)) {}

WeightPlane& SpaceTimeSystem::weights(RowKind kind, int t) {
  ScreenedLaplacian& of = is_temporal(kind) ? couplings_[size_t(t)] : frames_[size_t(t)];
  switch (kind) {
    case RowKind::kPrimal:
    case RowKind::kDt:
      return of.screen;
    case RowKind::kDx:
    case RowKind::kDxDt:
      return of.right;
    default:
      return of.up;
  }
}

void SpaceTimeSystem::set_weights(RowKind kind, int t, int y, float* values) {
  const int w = width();
  const bool to_right = kind == RowKind::kDx || kind == RowKind::kDxDt, upwards = kind == RowKind::kDy || kind == RowKind::kDyDt;
  if (to_right) values[w - 1] = 0.0f;
  if (upwards && y + 1 == height()) std::fill_n(values, w, 0.0f);
  if (is_temporal(kind)) {
    const Links::Shift* here = links(t).row(y);
    const Links::Shift* other = to_right ? here + 1 : upwards && y + 1 < height() ? links(t).row(y + 1) : here;
    for (int x = 0; x < w; ++x) {
      if (to_right && x + 1 == w) break;
      if (here[x] == Links::kNone || other[x] != here[x]) values[x] = 0.0f;
    }
  }
  weights(kind, t).write_row(y, values);
}

Sums SpaceTimeSystem::multiply(const Frames& x, Frames* out) const {
  Sums sums(size_t(x.front().channels()), 0.0);
  for (size_t t = 0; t < frames_.size(); ++t) {
    add(&sums, multiply_frame(int(t), x[t], &(*out)[t]));
    if (t > 0) add(&sums, multiply_coupling(int(t) - 1, x[t - 1], x[t], &(*out)[t - 1], &(*out)[t]));
  }
  return sums;
}

RowSums SpaceTimeSystem::multiply_frame(int t, const Field& x, Field* out) const {
  const int w = width(), channels = x.channels();
  RowSums sums(height(), channels);
  for_pieces(height(), [&](int begin, int end) {
    LaplacianRow weights(w);
    for (int y = begin; y < end; ++y) {
      weights.load(frame(t), y);
      for (int c = 0; c < channels; ++c) {
        weights.apply(x.row(y - 1, c), x.row(y, c), x.row(y + 1, c), out->row(y, c));
        sums.at(y, c) = dot_row(x.row(y, c), out->row(y, c), w);
      }
    }
  });
  return sums;
}

RowSums SpaceTimeSystem::multiply_coupling(int t, const Field& x, const Field& next, Field* out, Field* next_out) const {
  const int w = width(), channels = x.channels();
  RowSums sums(height(), channels);
  const Links& links = links_[size_t(t)];
  const auto fill = [&](int y, RollingRows* rows) {
    links.for_runs(y, [&](int begin, int end, int dx, int dy) {
      for (int c = 0; c < channels; ++c) {
        const float *from = x.row(y, c), *there = next.row(y + dy, c) + dx;
        float* to = rows->row(y, c);
        for (int i = begin; i < end; ++i) to[i] = there[i] - from[i];
      }
    });
  };
  for_product_rows(coupling(t), channels, fill, [&](int y, int c, const float* difference, const float* product) {
    float* to = out->row(y, c);
    for (int i = 0; i < w; ++i) to[i] -= product[i];
    scatter_row(links, y, c, product, next_out);
    sums.at(y, c) = dot_row(difference, product, w);
  });
  return sums;
}

void SpaceTimeSystem::pull(int t, const Field& next, Field* x) const {
  for_product_rows(
      coupling(t), next.channels(), [&](int y, RollingRows* rows) { gather_row(links(t), y, next, rows); },
      [&](int y, int c, const float*, const float* product) {
        float* to = x->row(y, c);
        for (int i = 0; i < width(); ++i) to[i] += product[i];
      });
}

void SpaceTimeSystem::push(int t, const Field& x, Field* next) const {
  const ScreenedLaplacian& k = coupling(t);
  for_pieces(height(), [&](int begin, int end) {
    LaplacianRow weights(width());
    std::vector<float> product(static_cast<size_t>(width()));
    for (int y = begin; y < end; ++y) {
      weights.load(k, y);
      for (int c = 0; c < x.channels(); ++c) {
        weights.apply(x.row(y - 1, c), x.row(y, c), x.row(y + 1, c), product.data());
        scatter_row(links(t), y, c, product.data(), next);
      }
    }
  });
}

void SpaceTimeSystem::right_side(const WindowSource& source, int first_channel, Frames* out) const {
  const int w = width(), channels = out->front().channels();
  for (int t = 0; t < frames(); ++t) {
    for_right_side(frame(t), source, {RowKind::kPrimal, RowKind::kDx, RowKind::kDy}, t, first_channel, channels,
                   [&](int y, int c, const float* row) { std::copy_n(row, w, (*out)[size_t(t)].row(y, c)); });
  }
  for (int t = 0; t + 1 < frames(); ++t) {
    for_right_side(coupling(t), source, {RowKind::kDt, RowKind::kDxDt, RowKind::kDyDt}, t, first_channel, channels,
                   [&](int y, int c, const float* row) {
                     float* to = (*out)[size_t(t)].row(y, c);
                     for (int x = 0; x < w; ++x) to[x] -= row[x];
                     scatter_row(links(t), y, c, row, &(*out)[size_t(t) + 1]);
                   });
  }
}

}  // namespace gradus
