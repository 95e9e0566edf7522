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
  {
    const float scale = robust_scale(frame.image.mean);
    frame.weights = weights_in_windows(in_units_of(scale, frame.image));
    for_values(&frame.weights, [&](float& value, int, int, int) { value /= scale * scale; });
  }
  frame.to_previous = correspondence_(number, cancel);
  return frames_.emplace(number, std::move(frame)).first->second;
}

void JointRegression::join(const Frame& frame, const PixelTrack& track, const Frame& here, const Field& still,
                           float scale, Joined* joined) {
  const int w = track.width, h = track.height;
  const float unit = median_depth(here.features);
  HalvedImage image{move(track, frame.image.mean), move(track, frame.image.half_difference)};
  normalise(scale, &image);
  const auto there = [&](int x, int y) { return track.source[size_t(y) * size_t(w) + size_t(x)] != film::kNoCorrespondence; };
  const auto displaced = [&](int x, int y) { return track.displacement[size_t(y) * size_t(w) + size_t(x)]; };
  // Depths as the picture sees them.
  const auto depth_of = [&](const film::Features& f) { return make_field(w, h, [&](int x, int y) { return f.depth.values[size_t(y) * size_t(w) + size_t(x)]; }); };
  Field depths = move(track, depth_of(frame.features));
  Field both(w, h, 2);
  for_values(&both, [&](float& value, int x, int y, int c) {
    if (there(x, y)) value = c == 0 ? depths.row(y)[x] : here.features.depth.values[size_t(y) * size_t(w) + size_t(x)];
  });
  both = box_mean(both, kDepthRadius);
  Field features = move(track, regression_features(frame.features, unit));
  for_values(&depths, [&](float& value, int x, int y, int) {
    const float from = both.row(y, 0)[x];
    if (from > 0.0f) value *= both.row(y, 1)[x] / from;
    features.row(y, 6)[x] = value > 0.0f ? value / (value + unit) : 0.0f;
  });
  // Test of the light.
  const HalvedImage own = in_units_of(scale, here.image);
  Field difference(w, h, 3), variance(w, h, 3);
  const Field weights = make_field(w, h, [&](int x, int y) {
    if (!there(x, y)) return 0.0f;
    float square = 1e-4f;
    for (int c = 0; c < 3; ++c) square += still.row(y, c)[x] * still.row(y, c)[x];
    return 1.0f / square;
  });
  const bool texture = env("LT_TEXTURE", 1) > 0;
  for_values(&difference, [&](float& value, int x, int y, int c) {
    if (!there(x, y)) return;
    value = image.mean.row(y, c)[x] - own.mean.row(y, c)[x];
    const Vec2 d = displaced(x, y);
    if (texture) value -= look_up(still, c, float(x) + d.x, float(y) + d.y) - still.row(y, c)[x];
    const float a = image.half_difference.row(y, c)[x], b = own.half_difference.row(y, c)[x];
    variance.row(y, c)[x] = a * a + b * b;
  });
  const Field kept = env("LT_OFF", 0) > 0 ? make_field(w, h, [](int, int) { return 1.0f; }) : same_light(difference, variance, weights);
  const auto add_weighted = [&](const Field& values, const Field& by, Field* sum) {
    for_values(sum, [&](float& value, int x, int y, int c) { value += by.row(y)[x] * values.row(y, c)[x]; });
  };
  const float s_mean = env("MEAN_S", 1.0f), s_feat = env("FEAT_S", 0.3f);
  const bool by_noise = env("MERGE_DEV", 1) > 0;
  const auto weight_by = [&](float sigma) {
    return make_field(w, h, [&](int x, int y) {
      if (!there(x, y)) return 0.0f;
      const Vec2 d = displaced(x, y);
      const int32_t from = track.source[size_t(y) * size_t(w) + size_t(x)];
      return (by_noise ? scale * scale * frame.weights.row(from / w)[from % w] : 1.0f) * kept.row(y)[x] * std::exp(-0.5f * (d.x * d.x + d.y * d.y) / (sigma * sigma));
    });
  };
  const Field weight = weight_by(s_mean), of_centre = weight_by(s_feat);
  add(weight, &joined->weight);
  add(of_centre, &joined->centre_weight);
  add_weighted(image.mean, weight, &joined->image.mean);
  add_weighted(image.half_difference, weight, &joined->image.half_difference);
  add_weighted(features, weight, &joined->features.sampled);
  add_weighted(features, of_centre, &joined->features.centre);
  for_values(&joined->features.displacement, [&](float& value, int x, int y, int c) {
    if (there(x, y)) value += weight.row(y)[x] * (c == 0 ? displaced(x, y).x : displaced(x, y).y);
  });
  if (env("LT_PRINT", 0) > 0) {
    double k = 0, n = 0;
    for (int y = 0; y < h; ++y) for (int x = 0; x < w; ++x) { n += there(x, y); k += there(x, y) ? kept.row(y)[x] : 0; }
    std::fprintf(stderr, "  matched %.3f kept %.3f\n", n / (double(w) * h), k / n);
  }
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
  const Field of_here = regression_features(here.features, median_depth(here.features));
  const auto ones = [&] { return make_field(w, h, [](int, int) { return 1.0f; }); };
  Joined joined{{of_here, Field(w, h, 2), of_here}, image, ones(), ones()};
  if (env("MERGE_DEV", 1) > 0) {
    joined.weight = joined.centre_weight = make_field(w, h, [&](int x, int y) { return scale * scale * here.weights.row(y)[x]; });
    const auto times = [&](Field* field) { for_values(field, [&](float& value, int x, int y, int) { value *= joined.weight.row(y)[x]; }); };
    times(&joined.image.mean); times(&joined.image.half_difference); times(&joined.features.sampled); times(&joined.features.centre);
  }
  for (int other = around.first; other <= around.last; ++other) {
    if (other == number) continue;
    PixelTrack track = own_pixels(w, h);
    for (int t = other + 1; t <= number; ++t) track = moved_on(track, frames_.at(t).to_previous);
    for (int t = other; t > number; --t) track = moved_back(track, frames_.at(t).to_previous);
    join(frames_.at(other), track, here, alone.image(), scale, &joined);
  }
  Field picture, error;
  if (around.first == around.last) { picture = alone.image(); error = alone.error(); }
  else {
    const auto divide = [](const Field& by, Field* field) { for_values(field, [&](float& value, int x, int y, int) { value /= by.row(y)[x]; }); };
    divide(joined.weight, &joined.image.mean);
    divide(joined.weight, &joined.image.half_difference);
    divide(joined.weight, &joined.features.sampled);
    divide(joined.weight, &joined.features.displacement);
    divide(joined.centre_weight, &joined.features.centre);
    if (env("FEAT_S", 0.3f) <= 0.0f) joined.features.centre = {};
    const FeatureRegression joint(std::move(joined.features), joined.image, cancel);
    picture = joint.image();
    error = joint.error();
  }
  scale_light(scale, &picture);
  for_values(&error, [scale](float& value, int, int, int) { value *= scale * scale; });
  return {interleave(picture), interleave(error)};
}

}  // namespace gradus::reconstruct
