#include "reconstruct/space_time/solve_tracks.h"

#include "base/fault.h"
#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

// Returns row y of the difference d in a channel, or zeros for a channel that the difference lacks.
const float* differences(const TrackStep& step, int y, int channel, const std::vector<float>& zeros) {
  if (GRADUS_FAULT(change_is_zero)) return zeros.data();
  return channel < step.difference.channels() ? step.difference.row(y, channel) : zeros.data();
}

// Eliminates a frame: adds its value v + d to the next frame, with the weight w·c/(w + c).
void carry_forth(const TrackStep& step, const Field& values, const Field& weights, Field* next_values,
                 Field* next_weights) {
  const std::vector<float> zeros(size_t(values.width()), 0.0f);
  for_rows(values.height(), [&](int y) {
    step.correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
      const float *w = weights.row(y), *c = step.weight.row(y);
      float* total = next_weights->row(y + dy) + dx;
      const auto carried = [&](int i) { return w[i] * (c[i] / (w[i] + c[i])); };
      for (int channel = 0; channel < values.channels(); ++channel) {
        const float *v = values.row(y, channel), *d = differences(step, y, channel, zeros);
        float* to = next_values->row(y + dy, channel) + dx;
        for (int i = begin; i < end; ++i) to[i] += carried(i) / (total[i] + carried(i)) * (v[i] + d[i] - to[i]);
      }
      for (int i = begin; i < end; ++i) total[i] += carried(i);
    });
  });
}

// Substitutes the solution of the next frame into a frame.
void carry_back(const TrackStep& step, const Field& next, const Field& weights, Field* values) {
  const std::vector<float> zeros(size_t(values->width()), 0.0f);
  for_rows(values->height(), [&](int y) {
    step.correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
      const float *w = weights.row(y), *c = step.weight.row(y);
      for (int channel = 0; channel < values->channels(); ++channel) {
        const float *x = next.row(y + dy, channel) + dx, *d = differences(step, y, channel, zeros);
        float* to = values->row(y, channel);
        for (int i = begin; i < end; ++i) to[i] += c[i] / (w[i] + c[i]) * (x[i] - d[i] - to[i]);
      }
    });
  });
}

}  // namespace

void solve_tracks(const std::vector<TrackStep>& steps, std::vector<Field>* values, std::vector<Field>* weights) {
  std::vector<Field>&v = *values, &w = *weights;
  for (size_t t = 0; t < steps.size(); ++t) carry_forth(steps[t], v[t], w[t], &v[t + 1], &w[t + 1]);
  for (size_t t = steps.size(); t-- > 0;) carry_back(steps[t], v[t + 1], w[t], &v[t]);
}

}  // namespace gradus::reconstruct
