#include "reconstruct/space_time/joint_regression.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstdio>
#include <optional>

#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/light_test.h"

namespace gradus::reconstruct {
namespace {

float env(const char* name, float standard) {
  const char* text = std::getenv(name);
  return text ? float(std::atof(text)) : standard;
}

constexpr int kDepthRadius = 2;

HalvedImage in_units_of(float scale, HalvedImage image) {
  normalise(scale, &image);
  return image;
}

// Moves values along a track; 0 where there is none.
Field move(const PixelTrack& track, const Field& from) {
  const size_t w = size_t(track.width);
  Field to(track.width, track.height, from.channels());
  for_rows(track.height, [&](int y) {
    for (size_t x = 0; x < w; ++x) {
      const int32_t source = track.source[size_t(y) * w + x];
      if (source == film::kNoCorrespondence) continue;
      for (int c = 0; c < from.channels(); ++c) to.row(y, c)[x] = from.row(source / track.width, c)[source % track.width];
    }
  });
  return to;
}

// Field value at a fractional place, bilinear.
float look_up(const Field& image, int c, float x, float y) {
  const int i = std::clamp(int(std::floor(x)), 0, image.width() - 1), j = std::clamp(int(std::floor(y)), 0, image.height() - 1);
  const int i1 = std::min(i + 1, image.width() - 1), j1 = std::min(j + 1, image.height() - 1);
  const float u = std::clamp(x - float(i), 0.0f, 1.0f), v = std::clamp(y - float(j), 0.0f, 1.0f);
  const float *a = image.row(j, c), *b = image.row(j1, c);
  return (1 - v) * ((1 - u) * a[i] + u * a[i1]) + v * ((1 - u) * b[i] + u * b[i1]);
}

float closeness(const MovedFrame& moved, int x, int y, float sigma) {
  const float dx = moved.displacement.row(y, 0)[x], dy = moved.displacement.row(y, 1)[x];
  return std::exp(-0.5f * (dx * dx + dy * dy) / (sigma * sigma));
}

}  // namespace

const JointRegression::Frame& JointRegression::frame(int number, const CancelCheck& cancel) {
  const auto known = frames_.find(number);
  if (known != frames_.end()) return known->second;
  const std::shared_ptr<const film::Film> film = open_(number, cancel);
  Frame frame;
  frame.features = filter_features(film::read_features(*film));
  std::optional<film::Film> of_components;
  if (film->components.size() > 1) of_components = film::sum_components(*film);
  const film::Film* sum = of_components ? &*of_components : film.get();
  frame.image = read_halves(*sum, [&](size_t i) {
    return HalfSums{Rgb(sum->components[0].primal[0][i]), Rgb(sum->components[0].primal[1][i])};
  });
  const float scale = robust_scale(frame.image.mean);
  const HalvedImage relative = in_units_of(scale, frame.image);
  frame.deviation = deviation_in_windows(relative);
  for_values(&frame.deviation, [&](float& value, int, int, int) { value *= scale; });
  frame.own = own_weights(relative);
  for_values(&frame.own, [&](float& value, int, int, int) { value /= scale * scale; });
  frame.to_previous = correspondence_(number, cancel);
  return frames_.emplace(number, std::move(frame)).first->second;
}

MovedFrame JointRegression::moved(const Frame& frame, const PixelTrack& track, const Frame& here, const Field& still,
                                  float scale) {
  const int w = track.width, h = track.height;
  const float unit = median_depth(here.features);
  MovedFrame moved;
  moved.image = {move(track, frame.image.mean), move(track, frame.image.half_difference)};
  normalise(scale, &moved.image);
  moved.deviation = move(track, frame.deviation);
  for_values(&moved.deviation, [&](float& value, int, int, int) { value /= scale; });
  moved.displacement = Field(w, h, 2);
  for_values(&moved.displacement, [&](float& value, int x, int y, int c) {
    const Vec2& d = track.displacement[size_t(y) * size_t(w) + size_t(x)];
    value = c == 0 ? d.x : d.y;
  });
  // Depths as the picture sees them.
  film::Features features = frame.features;
  Field depths(w, h, 1);
  for_values(&depths, [&](float& value, int x, int y, int) { value = frame.features.depth.values[size_t(y) * size_t(w) + size_t(x)]; });
  depths = move(track, depths);
  Field both(w, h, 2);
  for_values(&both, [&](float& value, int x, int y, int c) {
    if (track.source[size_t(y) * size_t(w) + size_t(x)] == film::kNoCorrespondence) return;
    value = c == 0 ? depths.row(y)[x] : here.features.depth.values[size_t(y) * size_t(w) + size_t(x)];
  });
  both = box_mean(both, kDepthRadius);
  moved.features = move(track, regression_features(frame.features, unit));
  for_values(&depths, [&](float& value, int x, int y, int) {
    const float from = both.row(y, 0)[x];
    if (from > 0.0f) value *= both.row(y, 1)[x] / from;
    moved.features.row(y, 6)[x] = value > 0.0f ? value / (value + unit) : 0.0f;
  });
  // Test of the light.
  const HalvedImage own = in_units_of(scale, here.image);
  Field difference(w, h, 3), variance(w, h, 3);
  const Field weights = make_field(w, h, [&](int x, int y) {
    const float a = moved.deviation.row(y)[x], b = here.deviation.row(y)[x] / scale;
    return a > 0.0f ? 1.0f / (a * a + b * b) : 0.0f;
  });
  const bool texture = env("LT_TEXTURE", 1) > 0;
  for_values(&difference, [&](float& value, int x, int y, int c) {
    if (weights.row(y)[x] == 0.0f) return;
    value = moved.image.mean.row(y, c)[x] - own.mean.row(y, c)[x];
    if (texture)
      value -= look_up(still, c, float(x) + moved.displacement.row(y, 0)[x], float(y) + moved.displacement.row(y, 1)[x]) -
               still.row(y, c)[x];
    const float a = moved.image.half_difference.row(y, c)[x], b = own.half_difference.row(y, c)[x];
    variance.row(y, c)[x] = a * a + b * b;
  });
  moved.kept = env("LT_OFF", 0) > 0 ? make_field(w, h, [](int, int) { return 1.0f; }) : same_light(difference, variance, weights);
  moved.own = move(track, frame.own);
  const float own_s = env("OWN_S", 0.25f);
  for_values(&moved.own, [&](float& value, int x, int y, int) { value *= scale * scale * moved.kept.row(y)[x] * closeness(moved, x, y, own_s); });
  if (env("LT_PRINT", 0) > 0) {
    double kept = 0, there = 0;
    for (int y = 0; y < h; ++y) for (int x = 0; x < w; ++x) { there += weights.row(y)[x] > 0; kept += weights.row(y)[x] > 0 ? moved.kept.row(y)[x] : 0; }
    std::fprintf(stderr, "  matched %.3f kept %.3f\n", there / (double(w) * h), kept / there);
  }
  return moved;
}

Reconstructed JointRegression::reconstruct(int number, const FrameRange& around, const CancelCheck& cancel,
                                           SolveReport*) {
  frames_.erase(frames_.begin(), frames_.lower_bound(around.first));
  const Frame& here = frame(number, cancel);
  for (int other = around.first; other <= around.last && !cancel(); ++other) frame(other, cancel);
  if (cancel()) return {};
  const int w = here.image.mean.width(), h = here.image.mean.height();
  const float scale = robust_scale(here.image.mean);
  const HalvedImage image = in_units_of(scale, here.image);
  const FeatureRegression alone(here.features, image, cancel);
  std::vector<MovedFrame> others;
  for (int other = around.first; other <= around.last; ++other) {
    if (other == number) continue;
    PixelTrack track = own_pixels(w, h);
    for (int t = other + 1; t <= number; ++t) track = moved_on(track, frames_.at(t).to_previous);
    for (int t = other; t > number; --t) track = moved_back(track, frames_.at(t).to_previous);
    others.push_back(moved(frames_.at(other), track, here, alone.image(), scale));
  }
  Field picture, error;
  if (others.empty()) { picture = alone.image(); error = alone.error(); }
  else {
    std::shared_ptr<Field> estimated;
    if (const float sigma = env("FEAT_S", 0.3f); sigma > 0) {
      estimated = std::make_shared<Field>(regression_features(here.features, median_depth(here.features)));
      Field total = make_field(w, h, [](int, int) { return 1.0f; });
      for (const MovedFrame& other : others) {
        const Field weight = make_field(w, h, [&](int x, int y) {
          return other.deviation.row(y)[x] > 0.0f ? other.kept.row(y)[x] * closeness(other, x, y, sigma) : 0.0f;
        });
        for_values(estimated.get(), [&](float& value, int x, int y, int c) { value += weight.row(y)[x] * other.features.row(y, c)[x]; });
        add(weight, &total);
      }
      for_values(estimated.get(), [&](float& value, int x, int y, int) { value /= total.row(y)[x]; });
    }
    const FeatureRegression joint(here.features, image, cancel, nullptr, others, estimated);
    picture = joint.image();
    error = joint.error();
  }
  scale_light(scale, &picture);
  for_values(&error, [scale](float& value, int, int, int) { value *= scale * scale; });
  return {interleave(picture), interleave(error)};
}

}  // namespace gradus::reconstruct
