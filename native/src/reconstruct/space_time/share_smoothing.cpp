#include "reconstruct/space_time/share_smoothing.h"

#include <algorithm>

#include "reconstruct/field_values.h"
#include "reconstruct/space_time/solve_tracks.h"

namespace gradus::reconstruct {
namespace {

// Minimum of light, so that quotients of black pixels and their squares are finite.
constexpr float kMinLight = 1e-15f;

Frames to_fields(const std::vector<WeightPlane>& planes) {
  Frames fields;
  for (const WeightPlane& plane : planes) {
    Field& field = fields.emplace_back(plane.width(), plane.height(), 1);
    for_rows(plane.height(), [&](int y) { plane.read_row(y, field.row(y)); });
  }
  return fields;
}

// Writes the ratio of the smaller to the larger light in the channel that changes most.
void min_ratios(const Field& light, const Field& next, int y, int begin, int end, int dx, int dy, float* ratio) {
  std::fill(ratio + begin, ratio + end, 1.0f);
  for (int c = 0; c < light.channels(); ++c) {
    const float *a = light.row(y, c), *b = next.row(y + dy, c) + dx;
    for (int x = begin; x < end; ++x) ratio[x] = std::min(ratio[x], std::min(a[x], b[x]) / std::max(a[x], b[x]));
  }
}

// Returns the weights c (share_smoothing.h); 0 for pixels without a correspondence.
Field weigh_correspondence(const CorrespondenceMap& correspondence, const Field& light, const Field& next) {
  Field weights(light.width(), light.height(), 1);
  for_rows(light.height(), [&](int y) {
    float* weight = weights.row(y);
    correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
      min_ratios(light, next, y, begin, end, dx, dy, weight);
      for (int x = begin; x < end; ++x)
        weight[x] *= weight[x] * std::min(mean_of(light, x, y), mean_of(next, x + dx, y + dy));
    });
  });
  return weights;
}

}  // namespace

void ShareSmoothing::add_frame(Field light, const CorrespondenceMap* correspondence) {
  for_values(&light, [](float& value, int, int, int) { value = std::max(value, kMinLight); });
  lights_.push_back(
      to_plane(make_field(light.width(), light.height(), [&](int x, int y) { return mean_of(light, x, y); })));
  if (lights_.size() > 1) couplings_.push_back(to_plane(weigh_correspondence(*correspondence, last_, light)));
  last_ = std::move(light);
}

void ShareSmoothing::apply(const SpaceTimeSystem& system, float data_weight, Frames* values) const {
  const Frames lights = to_fields(lights_), couplings = to_fields(couplings_);
  Frames weights = lights;
  for (size_t t = 0; t < lights.size(); ++t) {
    for_values(&weights[t], [&](float& value, int, int, int) { value *= data_weight; });
    for_values(&(*values)[t], [&](float& value, int x, int y, int) { value /= lights[t].row(y)[x]; });
  }
  const Field no_difference;
  std::vector<TrackStep> steps;
  for (size_t t = 0; t < couplings.size(); ++t)
    steps.push_back({system.correspondence(int(t)), no_difference, couplings[t]});
  solve_tracks(steps, values, &weights);
  for (size_t t = 0; t < lights.size(); ++t) {
    for_values(&(*values)[t], [&](float& value, int x, int y, int) { value *= lights[t].row(y)[x]; });
  }
}

}  // namespace gradus::reconstruct
