#include "reconstruct/space_time/joint_regression.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/fault.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/displaced.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/light_test.h"

namespace gradus::reconstruct {
namespace {

// Standard deviations, in pixels, of the Gaussian weights by the displacement of a sample from the centre of its pixel,
// in the mean features and in the mean of own values. Samples count in windows wherever they lie.
constexpr float kFeatureReach = 0.2f, kOwnReach = 0.25f;
// Radius of the squares in which the mean depth of a frame's samples is compared with that of the picture.
constexpr int kDepthRadius = 2;
constexpr int kDepth = 6;  // channel of the depth among the features

void scale_values(float factor, Field* field) {
  for_values(field, [factor](float& value, int, int, int) { value *= factor; });
}

// Moves the values of a frame to the pixels of the picture; 0 where there is none.
Field move(const PixelTrack& track, const Field& from) {
  const auto w = size_t(track.width);
  Field to(track.width, track.height, from.channels());
  for_rows(track.height, [&](int y) {
    for (size_t x = 0; x < w; ++x) {
      const int32_t source = track.source[size_t(y) * w + x];
      if (source == film::kNoCorrespondence) continue;
      for (int c = 0; c < from.channels(); ++c)
        to.row(y, c)[x] = from.row(source / track.width, c)[source % track.width];
    }
  });
  return to;
}

Field displacement_of(const PixelTrack& track) {
  Field displacement(track.width, track.height, 2);
  if (GRADUS_FAULT(displacements_dropped)) return displacement;
  for_values(&displacement, [&](float& value, int x, int y, int c) {
    const Vec2& d = track.displacement[size_t(y) * size_t(track.width) + size_t(x)];
    value = c == 0 ? d.x : d.y;
  });
  return displacement;
}

// Returns the weights by displacement; 0 in pixels without a sample.
Field weigh_displacement(const PixelTrack& track, float reach) {
  return make_field(track.width, track.height, [&](int x, int y) {
    const size_t i = size_t(y) * size_t(track.width) + size_t(x);
    if (track.source[i] == film::kNoCorrespondence) return 0.0f;
    const Vec2& d = track.displacement[i];
    return std::exp(-0.5f * (d.x * d.x + d.y * d.y) / (reach * reach));
  });
}

Field times(Field field, const Field& factors) {
  scale_by(factors, &field);
  return field;
}

// Converts the depths of a frame to those that the picture sees of the same surfaces: in proportion to the mean depths
// around each pixel, so that what lies behind an edge stays behind it.
void move_depths(const PixelTrack& track, const Field& depths_here, float unit, Field* features) {
  Field both(track.width, track.height, 2);
  for_values(&both, [&](float& value, int x, int y, int c) {
    if (track.source[size_t(y) * size_t(track.width) + size_t(x)] == film::kNoCorrespondence) return;
    value = c == 0 ? features->row(y, kDepth)[x] : depths_here.row(y)[x];
  });
  both = box_mean(both, kDepthRadius);
  for_rows(track.height, [&](int y) {
    float* depths = features->row(y, kDepth);
    const float *there = both.row(y, 0), *here = both.row(y, 1);
    for (int x = 0; x < track.width; ++x)
      depths[x] = relative_depth(there[x] > 0.0f ? depths[x] * (here[x] / there[x]) : depths[x], unit);
  });
}

// Returns the change of the light between the picture and the samples of another frame: their difference, less that of
// the picture between the places of the samples and the centres of their pixels.
template <class Picture>
LightChange change_of_light(const Picture& here, const Predictors& moved, const HalvedImage& there) {
  const int w = moved.weights.width(), h = moved.weights.height();
  LightChange change{Field(w, h, 3), Field(w, h, 3), Field(w, h, 1)};
  for_values(&change.weight, [&](float& value, int x, int y, int) {
    const float a = moved.weights.row(y)[x], b = here.weights.row(y)[x];
    value = a > 0.0f ? a * b / (a + b) : 0.0f;
  });
  const Field expected = displaced(here.alone, moved.displacement);
  for_values(&change.difference, [&](float& value, int x, int y, int c) {
    if (moved.weights.row(y)[x] == 0.0f) return;
    value = there.mean.row(y, c)[x] - here.image.mean.row(y, c)[x] - (expected.row(y, c)[x] - here.alone.row(y, c)[x]);
    const float a = there.half_difference.row(y, c)[x], b = here.image.half_difference.row(y, c)[x];
    change.variance.row(y, c)[x] = a * a + b * b;
  });
  return change;
}

}  // namespace

const JointRegression::Frame& JointRegression::frame(int number, const CancelCheck& cancel) {
  const auto known = frames_.find(number);
  if (known != frames_.end()) return known->second;
  const std::shared_ptr<const film::Film> film = open_film_(number, cancel);
  Frame frame;
  frame.step = open_step_(number, cancel);
  const film::Features features = filter_features(film::read_features(*film));
  frame.typical_depth = typical_depth(features);
  frame.features = regression_features(features, 1.0f);
  for_values(&frame.features, [&](float& value, int x, int y, int c) {
    if (c == kDepth) value = features.depth.values[size_t(y) * size_t(features.width) + size_t(x)];
    if (!is_finite(value)) value = 0.0f;
  });
  frame.image = read_sum(*film);
  const float scale = robust_scale(frame.image.mean);
  HalvedImage relative = frame.image;
  normalise(scale, &relative);
  frame.weights = weigh_pixels(relative);
  scale_values(1.0f / (scale * scale), &frame.weights.in_windows);
  scale_values(1.0f / (scale * scale), &frame.weights.own);
  if (film->components.size() > 1 || film->color_channels > 3) {
    for (size_t k = 0; k < film->components.size(); ++k) frame.sampled.push_back(read_sampled(*film, int(k), 1.0f));
  }
  return frames_.emplace(number, std::move(frame)).first->second;
}

PixelTrack JointRegression::track(int other, int frame) const {
  const Field& size = frames_.at(frame).features;
  PixelTrack track = own_pixels(size.width(), size.height());
  const auto is_repeated = [&](int t) {
    const auto before = frames_.find(t - 1);
    return before != frames_.end() && before->second.step.stream == frames_.at(t).step.stream;
  };
  for (int t = other + 1; t <= frame; ++t) {
    if (!is_repeated(t)) track = moved_on(track, frames_.at(t).step.to_previous);
  }
  for (int t = other; t > frame; --t) {
    if (!is_repeated(t)) track = moved_back(track, frames_.at(t).step.to_previous);
  }
  return track;
}

JointRegression::Picture JointRegression::make_picture(const Frame& here, const CancelCheck& cancel) {
  Picture picture;
  picture.scale = robust_scale(here.image.mean);
  picture.unit = here.typical_depth;
  picture.image = here.image;
  normalise(picture.scale, &picture.image);
  picture.weights = here.weights.in_windows;
  scale_values(picture.scale * picture.scale, &picture.weights);
  picture.depths = channels_of(here.features, kDepth, 1);
  picture.alone = regress_coarsely({features_of(here), picture.weights}, picture.image, cancel);
  return picture;
}

Field JointRegression::move_frame(const Frame& frame, const PixelTrack& track, const Picture& picture,
                                  OtherFrames* others) {
  const float squared = picture.scale * picture.scale;
  MovedFrame moved;
  moved.image = {move(track, frame.image.mean), move(track, frame.image.half_difference)};
  normalise(picture.scale, &moved.image);
  Predictors predictors{move(track, frame.features), move(track, frame.weights.in_windows), displacement_of(track)};
  move_depths(track, picture.depths, picture.unit, &predictors.features);
  scale_values(squared, &predictors.weights);
  moved.kept = same_light(change_of_light(picture, predictors, moved.image));
  for_values(&moved.kept, [&](float& share, int x, int y, int) {
    if (predictors.weights.row(y)[x] == 0.0f) share = 0.0f;
  });
  predictors.weights = times(std::move(predictors.weights), moved.kept);
  moved.own = times(times(move(track, frame.weights.own), moved.kept), weigh_displacement(track, kOwnReach));
  scale_values(squared, &moved.own);
  moved.predictors = std::make_shared<const Predictors>(std::move(predictors));
  others->frames.push_back(std::move(moved));
  if (!frame.sampled.empty()) {
    std::vector<Field>& sampled = others->sampled.emplace_back();
    for (const Field& component : frame.sampled) {
      sampled.push_back(move(track, component));
      scale_light(1.0f / picture.scale, &sampled.back());
    }
  }
  return others->frames.back().kept;
}

Field JointRegression::features_of(const Frame& frame) {
  Field features = frame.features;
  for_rows(features.height(), [&](int y) {
    float* depths = features.row(y, kDepth);
    for (int x = 0; x < features.width(); ++x) depths[x] = relative_depth(depths[x], frame.typical_depth);
  });
  return features;
}

OtherFrames JointRegression::join(int number, const std::vector<int>& numbers, const CancelCheck& cancel) const {
  if (numbers.empty()) return {};
  const Frame& here = frames_.at(number);
  const Picture picture = make_picture(here, cancel);
  const int w = here.features.width(), h = here.features.height();
  OtherFrames others;
  auto mean = std::make_shared<Field>(features_of(here));
  Field total = make_field(w, h, [](int, int) { return 1.0f; });
  for (const int other : numbers) {
    if (cancel()) return {};
    const Frame& frame = frames_.at(GRADUS_FAULT(samples_of_another_frame) ? number : other);
    const PixelTrack track = this->track(other, number);
    const Field kept = move_frame(frame, track, picture, &others);
    const Field weight = times(weigh_displacement(track, kFeatureReach), kept);
    add(times(others.frames.back().predictors->features, weight), mean.get());
    add(weight, &total);
  }
  for_values(mean.get(), [&](float& value, int x, int y, int) { value /= total.row(y)[x]; });
  others.features = std::move(mean);
  return others;
}

Reconstructed JointRegression::reconstruct(int number, const FrameRange& around, const CancelCheck& cancel,
                                           SolveReport* report) {
  frames_.erase(frames_.begin(), frames_.lower_bound(around.first));
  for (int other = around.first; other <= around.last && !cancel(); ++other) frame(other, cancel);
  if (cancel()) return {};
  // Frames that are repeated have the same samples.
  std::set<int32_t> streams{frames_.at(number).step.stream};
  std::vector<int> numbers;
  for (int distance = 1; distance < around.count(); ++distance) {
    for (const int other : {number - distance, number + distance}) {
      if (around.contains(other) && streams.insert(frames_.at(other).step.stream).second) numbers.push_back(other);
    }
  }
  // Repeated frames sum the others in one order.
  std::sort(numbers.begin(), numbers.end());
  const std::shared_ptr<const film::Film> film = open_film_(number, cancel);
  const OtherFrames others = join(number, numbers, cancel);
  if (cancel()) return {};
  return regularize(*film, features_of(frames_.at(number)), others, film->components.size() > 1, cancel, report,
                    ErrorUse::Delivered);
}

}  // namespace gradus::reconstruct
