#include "reconstruct/space_time/regularized_windows.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/fault.h"
#include "reconstruct/field_values.h"
#include "reconstruct/linear_terms.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/solve_tracks.h"

namespace gradus::reconstruct {
namespace {

// Minimum of the squared error, in units of the squared median luminance.
constexpr float kMinError = 1e-6f;
// Squared distance of two pictures that their errors explain, in units of the squared error: eight standard deviations.
constexpr float kExplained = 64.0f;

Field to_field(const film::Film& film, const std::vector<float>& image, int channels) {
  const auto w = size_t(film.region.width()), n = size_t(channels);
  Field field(film.region.width(), film.region.height(), channels);
  for_values(&field,
             [&](float& value, int x, int y, int c) { value = image[(size_t(y) * w + size_t(x)) * n + size_t(c)]; });
  return field;
}

// Returns the median luminance of the sum of the pictures.
float scale_of(const std::vector<Field>& pictures) {
  Field colours(pictures[0].width(), pictures[0].height(), kColors);
  for (const Field& picture : pictures) {
    for_values(&colours, [&](float& value, int x, int y, int c) { value += picture.row(y, c)[x]; });
  }
  return robust_scale(colours);
}

// The difference between the pictures' change and the estimated change, summed over the components, and the squared
// error of the pictures at both ends of the correspondence: the maximum over the components.
struct Contradiction {
  Field colours, error;
};

Contradiction measure(const Change& change, const std::vector<Field>& here, const std::vector<Field>& next,
                      const Field& error, const Field& next_error) {
  const int w = error.width(), h = error.height();
  Contradiction contradiction{Field(w, h, kColors), Field(w, h, 1)};
  for (size_t k = 0; k < here.size(); ++k) {
    for_rows(h, [&](int y) {
      change.correspondence[k].for_runs(y, [&](int begin, int end, int dx, int dy) {
        for (int c = 0; c < kColors; ++c) {
          const float *from = here[k].row(y, c), *to = next[k].row(y + dy, c) + dx,
                      *difference = change.difference[k].row(y, c);
          float* sum = contradiction.colours.row(y, c);
          for (int i = begin; i < end; ++i) sum[i] += to[i] - from[i] - difference[i];
        }
        const float *e = error.row(y), *e_next = next_error.row(y + dy) + dx;
        float* maximum = contradiction.error.row(y);
        for (int i = begin; i < end; ++i) maximum[i] = std::max(maximum[i], e[i] + e_next[i]);
      });
    });
  }
  return contradiction;
}

// Returns the weights of a change. Where the pictures contradict the change by more than their errors explain, the
// excess is added to its squared error.
Field weigh_change(const Change& change, const Contradiction& contradiction) {
  return make_field(contradiction.error.width(), contradiction.error.height(), [&](int x, int y) {
    const float weight = change.weight.row(y)[x];
    const float excess =
        mean_of_squares(contradiction.colours, x, y) - kExplained * (contradiction.error.row(y)[x] + 1.0f / weight);
    return excess > 0.0f && !GRADUS_FAULT(contradicting_change_keeps_weight) ? track_weight(1.0f / weight + excess)
                                                                             : weight;
  });
}

void check_size(const std::vector<Field>& pictures, const ComponentSources& sources) {
  const auto same = [](const Field& picture, const std::unique_ptr<HalvedWindowSource>& source) {
    const WindowSize size = source->size();
    return picture.width() == size.width && picture.height() == size.height && picture.channels() == size.channels;
  };
  if (!std::equal(pictures.begin(), pictures.end(), sources.begin(), sources.end(), same)) {
    throw invalid_argument("a frame has another size than its window");
  }
}

// Makes the picture from its components, each of which has the error in an additional last channel.
Reconstructed to_picture(std::vector<Field> components, size_t brightest) {
  const int channels = components[0].channels() - 1;
  Reconstructed picture;
  for (const Field& component : components) picture.components.push_back(interleave(component, channels));
  picture.error = interleave(channels_of(components[brightest], channels, 1));
  picture.image = picture.components[0];
  for (size_t k = 1; k < picture.components.size(); ++k) {
    for (size_t i = 0; i < picture.image.size(); ++i) picture.image[i] += picture.components[k][i];
  }
  if (picture.components.size() == 1) picture.components.clear();
  return picture;
}

}  // namespace

void RegularizedWindows::reconstruct(const FrameRange& frames, const CancelCheck& cancel, SolveReport* report,
                                     const Take& take) {
  estimates_.erase(estimates_.begin(), estimates_.lower_bound(frames.first));
  std::vector<const Estimate*> window;
  for (int frame = frames.first; frame <= frames.last && !cancel(); ++frame) {
    window.push_back(&estimated(frame, frame < frames.last, cancel, report));
  }
  if (cancel()) return;
  std::vector<Field> couplings;
  for (size_t t = 0; t + 1 < window.size(); ++t) {
    const Estimate &here = *window[t], &next = *window[t + 1];
    couplings.push_back(
        weigh_change(*here.change, measure(*here.change, here.pictures, next.pictures, here.error, next.error)));
  }
  std::vector<std::vector<Field>> solved(window.size());  // by frame and component
  for (size_t k = 0; k < window[0]->pictures.size(); ++k) {
    std::vector<TrackStep> steps;
    for (size_t t = 0; t + 1 < window.size(); ++t) {
      steps.push_back({window[t]->change->correspondence[GRADUS_FAULT(components_follow_the_first) ? 0 : k],
                       window[t]->change->difference[k], couplings[t]});
    }
    std::vector<Field> pictures, weights;
    for (const Estimate* estimate : window) {
      pictures.push_back(join_channels(estimate->pictures[k], estimate->error));
      weights.push_back(estimate->weight);
    }
    solve_tracks(steps, &pictures, &weights);
    for (size_t t = 0; t < window.size(); ++t) solved[t].push_back(std::move(pictures[t]));
  }
  for (size_t t = 0; t < window.size(); ++t)
    take(int(t), to_picture(std::exchange(solved[t], {}), window[t]->brightest));
}

const RegularizedWindows::Estimate& RegularizedWindows::estimated(int frame, bool changes, const CancelCheck& cancel,
                                                                  SolveReport* report) {
  auto known = estimates_.find(frame);
  if (known == estimates_.end())
    known = estimates_.emplace(frame, estimate_single_frame(*open_(frame, cancel), cancel, report)).first;
  Estimate& estimate = known->second;
  if (!changes || estimate.change) return estimate;
  const bool is_late = GRADUS_FAULT(change_is_that_of_frame_before) && frame > 0;
  const ComponentSources sources = differences_(is_late ? frame - 1 : frame, cancel);
  check_size(estimate.pictures, sources);
  estimate.change = regress_change(sources, 0, estimate.pictures, std::exchange(estimate.features, {}),
                                   scale_of(estimate.pictures), cancel);
  return estimate;
}

RegularizedWindows::Estimate RegularizedWindows::estimate_single_frame(const film::Film& samples,
                                                                       const CancelCheck& cancel, SolveReport* report) {
  Estimate estimate;
  estimate.features = filter_features(film::read_features(samples));
  const Reconstructed picture = regularize(samples, estimate.features, samples.components.size() > 1, cancel, report);
  if (picture.components.empty()) estimate.pictures.push_back(to_field(samples, picture.image, samples.color_channels));
  for (const std::vector<float>& image : picture.components)
    estimate.pictures.push_back(to_field(samples, image, samples.color_channels));
  estimate.brightest = brightest(estimate.pictures);
  estimate.error = to_field(samples, picture.error, 1);
  const float scale = scale_of(estimate.pictures), minimum = kMinError * scale * scale;
  estimate.weight = make_field(samples.region.width(), samples.region.height(),
                               [&](int x, int y) { return track_weight(estimate.error.row(y)[x] + minimum); });
  return estimate;
}

}  // namespace gradus::reconstruct
