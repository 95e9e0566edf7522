#include "reconstruct/space_time/system.h"

#include "reconstruct/space_time/correspondence_rows.h"
#include "reconstruct/space_time/value_rows.h"

namespace gradus::reconstruct {
namespace {

std::vector<CorrespondenceMap> read_all_correspondences(const WindowSource& source) {
  std::vector<CorrespondenceMap> result;
  for (int t = 0; t + 1 < source.size().frames; ++t) result.push_back(read_correspondence(source, t));
  return result;
}

// Calls use(y, products) with the rows of W_s v + Dᵀ W_g g, of three kinds of rows; all channels one after another.
template <class Use>
void for_right_side(const ScreenedLaplacian& weights, const WindowSource& source, const RowKind (&kinds)[3], int t,
                    int first, int channels, const Use& use) {
  const int w = weights.width();
  for_pieces(weights.height(), [&](int begin, int end) {
    ValueRow value(source.size(), first, channels), right(value), up(value), down(value);
    LaplacianRow row(w);
    std::vector<float> products(size_t(w) * size_t(channels));
    const auto load = [&](RowKind kind, int y, ValueRow* to) {
      to->load(source, kind, t, y);
      to->replace_missing();
    };
    load(kinds[2], begin - 1, &up);
    for (int y = begin; y < end; ++y) {
      down.swap(up);
      load(kinds[0], y, &value);
      load(kinds[1], y, &right);
      load(kinds[2], y, &up);
      row.load(weights, y);
      for (int c = 0; c < channels; ++c) {
        const float *v = value.channel(c), *gx = right.channel(c), *gy = up.channel(c), *below = down.channel(c);
        float *out = products.data() + ptrdiff_t(c) * w, flux = 0.0f;
        for (int x = 0; x < w; ++x) {
          const float next_flux = row.right()[x] * gx[x];
          out[x] = row.screen()[x] * v[x] + flux - next_flux + row.down()[x] * below[x] - row.up()[x] * gy[x];
          flux = next_flux;
        }
      }
      use(y, products.data());
    }
  });
}

// A row of all channels, one after another.
void copy_row(const float* from, int y, Field* to) {
  for (int c = 0; c < to->channels(); ++c, from += to->width()) std::copy_n(from, to->width(), to->row(y, c));
}
void subtract_from_row(const float* from, int y, Field* to) {
  for (int c = 0; c < to->channels(); ++c, from += to->width()) {
    float* row = to->row(y, c);
    for (int x = 0; x < to->width(); ++x) row[x] -= from[x];
  }
}

void add(Sums* sums, const RowSums& rows) {
  const Sums more = rows.total();
  for (size_t c = 0; c < more.size(); ++c) (*sums)[c] += more[c];
}

}  // namespace

SpaceTimeSystem::SpaceTimeSystem(const WindowSource& source)
    : frames_(size_t(source.size().frames), ScreenedLaplacian(source.size().width, source.size().height)),
      couplings_(frames_.begin() + 1, frames_.end()),
      correspondence_(read_all_correspondences(source)) {}

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
  const bool to_right = kind == RowKind::kDx || kind == RowKind::kDxDt,
             upwards = kind == RowKind::kDy || kind == RowKind::kDyDt;
  if (to_right) values[w - 1] = 0.0f;
  if (upwards && y + 1 == height()) std::fill_n(values, w, 0.0f);
  if (is_temporal(kind)) {
    const CorrespondenceMap::Shift* here = correspondence(t).row(y);
    const CorrespondenceMap::Shift* other = to_right                      ? here + 1
                                            : upwards && y + 1 < height() ? correspondence(t).row(y + 1)
                                                                          : here;
    for (int x = 0; x < w; ++x) {
      if (to_right && x + 1 == w) break;
      if (here[x] == CorrespondenceMap::kNone || other[x] != here[x]) values[x] = 0.0f;
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

RowSums SpaceTimeSystem::multiply_coupling(int t, const Field& x, const Field& next, Field* out,
                                           Field* next_out) const {
  const int w = width(), channels = x.channels();
  RowSums sums(height(), channels);
  const auto subtract = [&](int y, RollingRows* rows) { subtract_row(correspondence(t), y, x, next, rows); };
  for_product_rows(coupling(t), channels, subtract, [&](int y, RollingRows* differences, const float* products) {
    subtract_from_row(products, y, out);
    scatter_row(correspondence(t), y, products, next_out);
    for (int c = 0; c < channels; ++c) sums.at(y, c) = dot_row(differences->row(y, c), products + ptrdiff_t(c) * w, w);
  });
  return sums;
}

void SpaceTimeSystem::right_side(const WindowSource& source, int first_channel, Frames* out) const {
  const int channels = out->front().channels();
  for (int t = 0; t < frames(); ++t) {
    for_right_side(frame(t), source, {RowKind::kPrimal, RowKind::kDx, RowKind::kDy}, t, first_channel, channels,
                   [&](int y, const float* products) { copy_row(products, y, &(*out)[size_t(t)]); });
  }
  for (int t = 0; t + 1 < frames(); ++t) {
    for_right_side(coupling(t), source, {RowKind::kDt, RowKind::kDxDt, RowKind::kDyDt}, t, first_channel, channels,
                   [&](int y, const float* products) {
                     subtract_from_row(products, y, &(*out)[size_t(t)]);
                     scatter_row(correspondence(t), y, products, &(*out)[size_t(t) + 1]);
                   });
  }
}

}  // namespace gradus::reconstruct
