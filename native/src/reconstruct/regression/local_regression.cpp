#include "reconstruct/regression/local_regression.h"

#include <algorithm>
#include <utility>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/fault.h"
#include "base/fpu.h"
#include "reconstruct/regression/regression_tile.h"

namespace gradus::reconstruct {
namespace {

// Size of a tile in blocks. With the margin that windows need, its width is a multiple of the vector length. Its
// moments fit in the second-level cache. A taller tile repeats less work at its margins. Components are black in much
// of the image, where small tiles can be skipped.
struct TileSize {
  int width, height;
};
constexpr TileSize kOfEstimate{72 - 2 * kReach, 96}, kOfApply{40 - 2 * kReach, 32};

const Field* or_null(const Field& field) { return field.width() > 0 ? &field : nullptr; }

template <int P, int C, bool Coordinates, bool Estimates>
void run_tiles(const RegressionTask& task, const OctaveTask<Estimates>& octave, const CancelCheck& cancel) {
  constexpr TileSize kTile = Estimates ? kOfEstimate : kOfApply;
  const int side = octave.octave.side;
  const int w = ceil_divided(task.width() + octave.shift, side), h = ceil_divided(task.height() + octave.shift, side);
  tbb::parallel_for(tbb::blocked_range2d<int>(0, ceil_divided(h, kTile.height), 1, 0, ceil_divided(w, kTile.width), 1),
                    [&](const tbb::blocked_range2d<int>& range) {
                      const FlushDenormals flush;
                      for (int j = range.rows().begin(); j < range.rows().end(); ++j) {
                        for (int i = range.cols().begin(); i < range.cols().end() && !cancel(); ++i) {
                          Tile<P, C, Coordinates, Estimates>(task, octave, i * kTile.width,
                                                             std::min(w, (i + 1) * kTile.width), j * kTile.height,
                                                             std::min(h, (j + 1) * kTile.height))
                              .run();
                        }
                      }
                    });
}

// Runs all octaves of one lattice after another, from the coarsest octave to the finest.
template <int P, int C, bool Coordinates, bool Estimates, class Confidence>
void run_octaves(const RegressionTask& task, const Confidence& confidence, const CancelCheck& cancel) {
  const std::vector<Octave>& octaves = task.settings->octaves;
  for (int shift = 0; shift < task.settings->lattices; ++shift) {
    Field coarse;
    for (size_t k = octaves.size(); k-- > 0;) {
      const int side = octaves[k].side;
      const Field above = std::exchange(
          coarse, k > 0 ? Field(ceil_divided(task.width() + shift, side), ceil_divided(task.height() + shift, side),
                                WindowEstimates<P, C, Coordinates>::kCount)
                        : Field());
      run_tiles<P, C, Coordinates, Estimates>(task,
                                              {octaves[k], shift, confidence(octaves.size() * size_t(shift) + k),
                                               or_null(above), k > 0 ? &coarse : nullptr},
                                              cancel);
    }
  }
}

template <int C, bool Estimates, class Confidence>
void run_features(const RegressionTask& task, const Confidence& confidence, const CancelCheck& cancel) {
  const int features = task.samples->in_windows->features.channels();
  const bool coordinates = task.settings->coordinates;
  if (features == 7 && coordinates) return run_octaves<10, C, true, Estimates>(task, confidence, cancel);
  if (features == 3 && !coordinates) return run_octaves<4, C, false, Estimates>(task, confidence, cancel);
  throw unsupported("regression on so many features");
}

}  // namespace

LocalRegression::LocalRegression(RegressionSamples samples, RegressionSettings settings)
    : samples_(std::move(samples)), settings_(std::move(settings)) {
  const int w = samples_.in_windows->weights.width(), h = samples_.in_windows->weights.height();
  for (int shift = 0; shift < settings_.lattices; ++shift) {
    for (const Octave& octave : settings_.octaves) {
      confidence_.emplace_back(ceil_divided(w + shift, octave.side) + kReach,
                               ceil_divided(h + shift, octave.side) + kReach, octave.small ? 2 : 1);
    }
  }
}

RegressionResult LocalRegression::estimate(const Values& mean, const Values& half_difference,
                                           const CancelCheck& cancel) {
  const int w = mean.in_windows->width(), h = mean.in_windows->height();
  RegressionResult result{Field(w, h, 3), Field(w, h, 3), Field(w, h, 1)};
  Field totals(w, h, 1);
  const RegressionTask task{&samples_,
                            {mean, GRADUS_FAULT(mean_regressed_as_difference) ? mean : half_difference},
                            {&result.mean, &result.noise},
                            &totals,
                            &result.bias,
                            &settings_};
  run_features<6, true>(
      task, [&](size_t i) { return &confidence_[i]; }, cancel);
  return result;
}

Field LocalRegression::apply(const Values& values, const CancelCheck& cancel) const {
  const int w = values.in_windows->width(), h = values.in_windows->height(), channels = values.in_windows->channels();
  Field result(w, h, channels), totals(w, h, 1);
  const RegressionTask task{&samples_, {values}, {&result}, &totals, nullptr, &settings_};
  const auto confidence = [&](size_t i) { return &confidence_[i]; };
  channels == 1 ? run_features<1, false>(task, confidence, cancel) : run_features<3, false>(task, confidence, cancel);
  return result;
}

}  // namespace gradus::reconstruct
