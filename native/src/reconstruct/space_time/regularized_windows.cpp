#include "reconstruct/space_time/regularized_windows.h"

#include <utility>

#include "base/error.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/solve_tracks.h"

namespace gradus {
namespace {

// Squared error of what shows none, in median luminances.
constexpr float kLeastError = 1e-6f;
// Squared distance that errors explain, in these: eight deviations.
constexpr float kExplained = 64.0f;
constexpr int kColors = 3;

// The picture, and its error in one more channel.
Field to_field(const Frame& frame, const Reconstructed& picture) {
  const size_t w = size_t(frame.region.width()), channels = size_t(frame.channels);
  Field field(frame.region.width(), frame.region.height(), frame.channels + 1);
  for_values(&field, [&](float& value, int x, int y, int c) {
    const size_t i = size_t(y) * w + size_t(x);
    value = c < frame.channels ? picture.image[i * channels + size_t(c)] : picture.error[i];
  });
  return field;
}

// Median luminance.
float scale_of(const Field& picture) {
  Field colours(picture.width(), picture.height(), 3);
  for_values(&colours, [&](float& value, int x, int y, int c) { value = picture.row(y, c)[x]; });
  return robust_scale(colours);
}

// Weights of a change. Where both pictures say otherwise, by more than their errors explain, it is known no better than it meets them.
Field weigh_change(const Change& change, const Field& here, const Field& next) {
  Field weight = change.weight;
  const int error = here.channels() - 1;
  for_rows(here.height(), [&](int y) {
    change.links.for_runs(y, [&](int begin, int end, int dx, int dy) {
      const float *e = here.row(y, error), *e_next = next.row(y + dy, error) + dx;
      float* c = weight.row(y);
      for (int i = begin; i < end; ++i) {
        float apart = 0.0f;
        for (int k = 0; k < kColors; ++k) {
          const float d = next.row(y + dy, k)[i + dx] - here.row(y, k)[i] - change.difference.row(y, k)[i];
          apart += d * d / kColors;
        }
        const float excess = apart - kExplained * (e[i] + e_next[i] + 1.0f / c[i]);
        if (excess > 0.0f) c[i] = track_weight(1.0f / c[i] + excess);
      }
    });
  });
  return weight;
}

// picture: with its error.
void check_size(const Field& picture, const WindowSize& size) {
  const bool same = picture.width() == size.width && picture.height() == size.height && picture.channels() == size.channels + 1;
  if (!same) throw invalid_argument("a frame has another size than its window");
}

Reconstructed to_picture(const Field& field) {
  const size_t pixels = size_t(field.width()) * size_t(field.height()), channels = size_t(field.channels() - 1);
  Reconstructed picture{std::vector<float>(pixels * channels), std::vector<float>(pixels)};
  for (size_t c = 0; c < channels; ++c) store_channel(field, int(c), channels, picture.image.data() + c);
  store_channel(field, int(channels), 1, picture.error.data());
  return picture;
}

}  // namespace

void RegularizedWindows::reconstruct(const FrameRange& frames, const CancelTest& cancel, SolveReport* report, const Take& take) {
  estimates_.erase(estimates_.begin(), estimates_.lower_bound(frames.first));
  std::vector<Field> pictures, weights;
  for (int frame = frames.first; frame <= frames.last && !cancel(); ++frame) {
    const Estimate& estimate = estimated(frame, frame < frames.last, cancel, report);
    pictures.push_back(estimate.picture);
    weights.push_back(estimate.weight);
  }
  if (cancel()) return;
  std::vector<Field> couplings;
  for (int frame = frames.first; frame < frames.last; ++frame) {
    couplings.push_back(weigh_change(*estimates_.at(frame).change, estimates_.at(frame).picture, estimates_.at(frame + 1).picture));
  }
  std::vector<TrackStep> steps;
  for (int frame = frames.first; frame < frames.last; ++frame) {
    const Change& change = *estimates_.at(frame).change;
    steps.push_back({change.links, change.difference, couplings[steps.size()]});
  }
  solve_tracks(steps, &pictures, &weights);
  for (int t = 0; t < frames.count(); ++t) take(t, to_picture(std::exchange(pictures[size_t(t)], {})));
}

const RegularizedWindows::Estimate& RegularizedWindows::estimated(int frame, bool changes, const CancelTest& cancel, SolveReport* report) {
  auto known = estimates_.find(frame);
  if (known == estimates_.end()) known = estimates_.emplace(frame, still(*open_(frame, cancel), cancel, report)).first;
  Estimate& estimate = known->second;
  if (!changes || estimate.change) return estimate;
  const std::unique_ptr<HalvedWindowSource> rows = differences_(frame, cancel);
  check_size(estimate.picture, rows->size());
  estimate.change = regress_change(*rows, 0, std::exchange(estimate.features, {}), scale_of(estimate.picture), cancel);
  return estimate;
}

RegularizedWindows::Estimate RegularizedWindows::still(const Frame& samples, const CancelTest& cancel, SolveReport* report) {
  Estimate estimate;
  estimate.features = ComponentGuides(samples).of(0);
  estimate.picture = to_field(samples, regularize(samples, 0, estimate.features, cancel, report));
  const float scale = scale_of(estimate.picture), least = kLeastError * scale * scale;
  estimate.weight = make_field(samples.region.width(), samples.region.height(),
                               [&](int x, int y) { return track_weight(estimate.picture.row(y, samples.channels)[x] + least); });
  return estimate;
}

}  // namespace gradus
