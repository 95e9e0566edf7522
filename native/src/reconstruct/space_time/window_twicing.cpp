#include "reconstruct/space_time/window_twicing.h"

#include <memory>

#include "reconstruct/space_time/track_smoothing.h"
#include "reconstruct/space_time/value_rows.h"
#include "reconstruct/twicing.h"

namespace gradus {
namespace {

// ‖I − x₀‖² by pixel.
Field squared_residuals(const WindowSource& source, int t, const Field& estimate) {
  const int w = estimate.width();
  Field squares(w, estimate.height(), 1);
  for_pieces(estimate.height(), [&](int begin, int end) {
    ValueRow primal(source.size(), 0, estimate.channels());
    for (int y = begin; y < end; ++y) {
      primal.load(source, RowKind::kPrimal, t, y);
      float* to = squares.row(y);
      for (int c = 0; c < estimate.channels(); ++c) {
        for (int x = 0; x < w; ++x) {
          const float e = primal.channel(c)[x] - estimate.row(y, c)[x];
          to[x] += e * e;
        }
      }
    }
  });
  return squares;
}

}  // namespace

WindowTwicing::WindowTwicing(const WindowSource& source, const Frames& estimate, float alpha)
    : dct_(source.size().width, source.size().height), data_weight_(alpha * alpha) {
  for (size_t t = 0; t < estimate.size(); ++t) {
    Field shares = squared_residuals(source, int(t), estimate[t]);
    limit_squares(&shares);
    WeightPlane& plane = shares_.emplace_back(shares.width(), shares.height());
    for_rows(shares.height(), [&](int y) { plane.write_row(y, shares.row(y)); });
  }
}

void WindowTwicing::apply(const WindowSource& planes, int first_channel, const SpaceTimeSystem& system, Frames* x) const {
  const size_t w = size_t(dct_.width()), channels = size_t(x->front().channels());
  const std::unique_ptr<float[]> work(new float[w * size_t(dct_.height()) * channels]);
  Frames lost = system.make_fields(int(channels));
  for (size_t t = 0; t < x->size(); ++t) {
    const auto fill = [&](int y, float* row) {
      ValueRow primal(planes.size(), first_channel, int(channels));
      primal.load(planes, RowKind::kPrimal, int(t), y);
      primal.replace_missing();
      std::vector<float> share(w);
      shares_[t].read_row(y, share.data());
      for (size_t c = 0; c < channels; ++c) {
        const float *value = primal.channel(int(c)), *here = (*x)[t].row(y, int(c));
        for (size_t i = 0; i < w; ++i) row[c * w + i] = data_weight_ * share[i] * (value[i] - here[i]);
      }
    };
    const auto take = [&](int y, const float* row) {
      for (size_t c = 0; c < channels; ++c) std::copy_n(row + c * w, w, lost[t].row(y, int(c)));
    };
    dct_.solve(data_weight_, int(channels), fill, {}, take, work.get());
  }
  smooth_tracks(system, data_weight_, &lost);
  for (size_t t = 0; t < x->size(); ++t) {
    for_rows(dct_.height(), [&](int y) {
      for (size_t c = 0; c < channels; ++c) {
        float* to = (*x)[t].row(y, int(c));
        const float* from = lost[t].row(y, int(c));
        for (size_t i = 0; i < w; ++i) to[i] += from[i];
      }
    });
  }
}

}  // namespace gradus
