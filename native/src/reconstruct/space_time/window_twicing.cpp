#include "reconstruct/space_time/window_twicing.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "reconstruct/field_values.h"
#include "reconstruct/poisson/twicing.h"
#include "reconstruct/space_time/value_rows.h"

namespace gradus::reconstruct {
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

WindowTwicing::WindowTwicing(const WindowSource& source, const Frames& estimate, const SpaceTimeSystem& system,
                             float alpha)
    : dct_(source.size().width, source.size().height), data_weight_(alpha * alpha) {
  for (size_t t = 0; t < estimate.size(); ++t) {
    Field kept = squared_residuals(source, int(t), estimate[t]);
    limit_blocks(&kept);
    kept_.push_back(to_plane(kept));
    const Field& frame = estimate[t];
    Field light = smooth_frame(frame.channels(), [&](int y, float* row) {
      for (int c = 0; c < frame.channels(); ++c, row += frame.width()) {
        std::transform(frame.row(y, c), frame.row(y, c) + frame.width(), row,
                       [](float value) { return std::fabs(value); });
      }
    });
    along_tracks_.add_frame(std::move(light), t > 0 ? &system.correspondence(int(t) - 1) : nullptr);
  }
}

void WindowTwicing::apply(const WindowSource& planes, int first_channel, const SpaceTimeSystem& system,
                          Frames* x) const {
  const size_t w = size_t(dct_.width()), channels = size_t(x->front().channels());
  Frames lost;
  for (size_t t = 0; t < x->size(); ++t) {
    lost.push_back(smooth_frame(int(channels), [&](int y, float* row) {
      ValueRow primal(planes.size(), first_channel, int(channels));
      primal.load(planes, RowKind::kPrimal, int(t), y);
      primal.replace_missing();
      std::vector<float> kept(w);
      kept_[t].read_row(y, kept.data());
      for (size_t c = 0; c < channels; ++c) {
        const float *value = primal.channel(int(c)), *here = (*x)[t].row(y, int(c));
        for (size_t i = 0; i < w; ++i) row[c * w + i] = kept[i] * (value[i] - here[i]);
      }
    }));
  }
  along_tracks_.apply(system, data_weight_, &lost);
  for (size_t t = 0; t < x->size(); ++t) {
    for_values(&(*x)[t], [&](float& value, int i, int y, int c) { value += lost[t].row(y, c)[i]; });
  }
}

Field WindowTwicing::smooth_frame(int channels, const PoissonDct::FillRow& fill) const {
  const size_t w = size_t(dct_.width()), count = w * size_t(channels);
  const std::unique_ptr<float[]> work(new float[count * size_t(dct_.height())]);
  Field smooth(dct_.width(), dct_.height(), channels);
  const auto fill_weighted = [&](int y, float* row) {
    fill(y, row);
    for (size_t i = 0; i < count; ++i) row[i] *= data_weight_;
  };
  const auto take = [&](int y, const float* row) {
    for (int c = 0; c < channels; ++c, row += w) std::copy_n(row, w, smooth.row(y, c));
  };
  dct_.solve(data_weight_, channels, fill_weighted, {}, take, work.get());
  return smooth;
}

}  // namespace gradus::reconstruct
