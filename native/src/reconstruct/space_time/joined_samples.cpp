#include "reconstruct/space_time/joined_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>

#include "base/fault.h"
#include "reconstruct/displaced.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/regression/moments.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/light_test.h"

namespace gradus::reconstruct {
namespace {

// Standard deviation, in pixels, of the Gaussian weights by the displacement of a sample from the centre of its pixel,
// in the means of own values. Samples count in windows wherever they lie.
constexpr float kReachOfCentre = 0.2f;
// Standard deviation of these weights in the features to estimate, and in the light that a denoiser reads. Both are
// larger: features that are a little blurred are better than noisy ones, and a network sharpens better than it removes
// noise.
constexpr float kReachOfFeatures = 0.25f, kReachOfSampled = 0.4f;
constexpr int kAlbedoChannels = kDepth - kAlbedo;

// Weights of one sample of a pixel, for each use. `share` is what the test of light keeps of it.
struct SampleWeights {
  float in_windows, own, of_residual, features, share;
};

using RecordValues = std::array<float, kRecordSize>;
static_assert(kRecordSize == 2 * kLanes && kRecordDepth >= kLanes);

// Sums of the values of records with one kind of weight.
class RecordSums {
 public:
  void add(float weight, const Lanes& low, const Lanes& high) {
    weight_ += weight;
    low_ += weight * low;
    high_ += weight * high;
  }
  float weight() const { return weight_; }
  // Returns the sums times `factor`.
  RecordValues sums(float factor = 1.0f) const {
    RecordValues values;
    store(factor * low_, values.data());
    store(factor * high_, values.data() + kLanes);
    return values;
  }
  RecordValues means() const { return sums(weight_ > 0.0f ? 1.0f / weight_ : 0.0f); }

 private:
  float weight_ = 0.0f;
  Lanes low_{}, high_{};
};

// Sums of the light of records, which is the lower half of their values.
static_assert(kRecordFeatures <= kLanes);
class LightSums {
 public:
  void add(float weight, const Lanes& low) {
    weight_ += weight;
    sums_ += weight * low;
  }
  float weight() const { return weight_; }
  std::array<float, kLanes> sums(float factor = 1.0f) const {
    std::array<float, kLanes> values;
    store(factor * sums_, values.data());
    return values;
  }
  std::array<float, kLanes> means() const { return sums(weight_ > 0.0f ? 1.0f / weight_ : 0.0f); }

 private:
  float weight_ = 0.0f;
  Lanes sums_{};
};

// Sums of the features of records, and of their squares, from which the noise of the means is estimated.
class FeatureSums {
 public:
  void add(float weight, const Lanes& low, const Lanes& high) {
    values_.add(weight, low, high);
    squares_.add(weight, low * low, high * high);
    squared_weight_ += weight * weight;
  }

  // Writes the means and their variances to pixel i of three images. The variance is that of weighted means whose terms
  // differ by noise alone; it is 0 for a single term, which was filtered by its own noise.
  void write(size_t i, film::Features* to) const {
    const float effective = squared_weight_ / (values_.weight() * values_.weight());
    const float factor = effective < 1.0f ? effective / (1.0f - effective) : 0.0f;
    const RecordValues mean = values_.means(), square = squares_.means();
    const auto put = [&](int first, size_t channels, film::FeatureImage* image) {
      for (size_t c = 0; c < channels; ++c) {
        const size_t of_record = size_t(kRecordFeatures + first) + c, of_image = channels * i + c;
        image->values[of_image] = mean[of_record];
        image->variance[of_image] = std::max(factor * (square[of_record] - mean[of_record] * mean[of_record]), 0.0f);
      }
    };
    put(0, 3, &to->normal);
    put(kAlbedo, 3, &to->albedo);
    put(kDepth, 1, &to->depth);
  }

 private:
  RecordSums values_, squares_;
  float squared_weight_ = 0.0f;
};

// A moved record holds its displacement in place of the weights of a frame's record.
constexpr int kDisplacement = kRecordWeight;

// The record of a sample as the picture sees it.
struct MovedRecord {
  Lanes low, high;
  float variance;
};

// Returns a record with light in units of the picture; `unit` is that of the film, `ratio` that of the frame's scale.
MovedRecord move_record(const float* record, float unit, float ratio, float depth, const Vec2& displacement) {
  const Lanes units = {unit, unit, unit, unit, unit, unit, 1.0f, 1.0f};
  MovedRecord moved{units * load(record), load(record + kLanes), ratio * ratio * record[kRecordVariance]};
  moved.high[kRecordDepth - kLanes] = depth;
  const Vec2 place = GRADUS_FAULT(displacements_dropped) ? Vec2{} : displacement;
  moved.high[kDisplacement - kLanes] = place.x;
  moved.high[kDisplacement + 1 - kLanes] = place.y;
  return moved;
}

// Sums of all samples of a pixel, for each use.
struct PixelSums {
  RecordSums in_windows, of_residual;
  FeatureSums features;
  LightSums own, light;
  float variance = 0.0f;
  std::array<float, 3> products{};  // of displacements, with the weights of the residual

  void add(const MovedRecord& record, const SampleWeights& weights) {
    in_windows.add(weights.in_windows, record.low, record.high);
    own.add(weights.own, record.low);
    of_residual.add(weights.of_residual, record.low, record.high);
    features.add(weights.features, record.low, record.high);
    light.add(weights.share, record.low);
    variance += weights.share * weights.share * record.variance;
    const float x = record.high[kDisplacement - kLanes], y = record.high[kDisplacement + 1 - kLanes];
    products[0] += weights.of_residual * x * x;
    products[1] += weights.of_residual * x * y;
    products[2] += weights.of_residual * y * y;
  }
};

// Returns the Gaussian weight of a displacement from the centre of a pixel.
float nearness(const Vec2& displacement, float reach) {
  const float squared = displacement.x * displacement.x + displacement.y * displacement.y;
  return std::exp(squared * (-0.5f / (reach * reach)));
}

// Returns the weights of a sample whose record is given. `ratio`: the frame's scale in that of the picture.
SampleWeights weigh_sample(const float* record, float ratio, float share, const Vec2& displacement) {
  const float near = nearness(displacement, kReachOfCentre), at_centre = nearness(displacement, kReachOfFeatures);
  const float of_light = 1.0f / (ratio * ratio), weight = of_light * record[kRecordWeight];
  return {share * weight, share * of_light * record[kRecordOwnWeight] * near, share * std::sqrt(std::sqrt(weight)),
          share * at_centre, share};
}

// Writes all channels of a field. The compiler knows their number, as this is done for 50 values of each pixel.
template <int Channels>
void put(const float* from, int x, int y, Field* to) {
  for (int c = 0; c < Channels; ++c) to->row(y, c)[x] = from[c];
}

// The planes of a picture's samples, which are written pixel by pixel.
struct PicturePlanes {
  PicturePlanes(int w, int h)
      : in_windows{Field(w, h, kFeatureChannels), Field(w, h, 1), Field(w, h, 2)},
        of_residual{Field(w, h, kAlbedoChannels), Field(w, h, 1), Field(w, h, kDisplacementChannels)},
        own_weights(w, h, 1),
        estimated{w, h, image_of(w, h, 3), image_of(w, h, 3), image_of(w, h, 1)},
        mean{Field(w, h, 3), Field(w, h, 3), Field(w, h, 3)},
        half_difference{Field(w, h, 3), Field(w, h, 3), Field(w, h, 3)},
        light{Field(w, h, 1), Field(w, h, 3), Field(w, h, 1)} {}

  void write(int x, int y, const PixelSums& sums) {
    const RecordValues windows = sums.in_windows.means(), residual = sums.of_residual.means();
    const std::array<float, kLanes> own = sums.own.means();
    size_t use = 0;
    for (const float* values : {windows.data(), own.data(), residual.data()}) {
      put<kColors>(values + kRecordMean, x, y, &mean[use]);
      put<kColors>(values + kRecordHalfDifference, x, y, &half_difference[use++]);
    }
    in_windows.weights.row(y)[x] = sums.in_windows.weight();
    put<kFeatureChannels>(windows.data() + kRecordFeatures, x, y, &in_windows.features);
    put<2>(windows.data() + kDisplacement, x, y, &in_windows.displacement);
    own_weights.row(y)[x] = sums.own.weight();
    sums.features.write(size_t(y) * size_t(estimated.width) + size_t(x), &estimated);
    of_residual.weights.row(y)[x] = sums.of_residual.weight();
    put<kAlbedoChannels>(residual.data() + kRecordFeatures + kAlbedo, x, y, &of_residual.features);
    const float unit = sums.of_residual.weight() > 0.0f ? 1.0f / sums.of_residual.weight() : 0.0f;
    for (int c = 0; c < kDisplacementChannels; ++c) {
      of_residual.displacement.row(y, c)[x] =
          c < 2 ? residual[size_t(kDisplacement + c)] : unit * sums.products[size_t(c - 2)];
    }
    light.share.row(y)[x] = sums.light.weight();
    put<kColors>(sums.light.sums().data() + kRecordMean, x, y, &light.light);
    light.variance.row(y)[x] = sums.variance;
  }

  // Returns the samples, and puts the features to estimate into `features`.
  PictureSamples take(Field noise, film::Features* features) {
    *features = filter_features(std::move(estimated));
    const auto shared = [](auto& value) {
      return std::make_shared<const std::remove_reference_t<decltype(value)>>(std::move(value));
    };
    const auto plane = [&](std::array<Field, 3>& of) {
      return JoinedPlane{shared(of[0]), shared(of[1]), shared(of[2])};
    };
    Field to_estimate(features->width, features->height, kFeatureChannels);
    for_values(&to_estimate, [&](float& value, int x, int y, int c) {
      value = feature_value(*features, size_t(y) * size_t(features->width) + size_t(x), c);
    });
    return {{shared(in_windows), shared(own_weights), shared(to_estimate)},
            std::move(of_residual),
            plane(mean),
            plane(half_difference),
            std::move(light),
            std::move(noise)};
  }

 private:
  static film::FeatureImage image_of(int w, int h, uint32_t channels) {
    const size_t count = size_t(w) * size_t(h) * channels;
    return {channels, std::vector<float>(count), std::vector<float>(count)};
  }

  Predictors in_windows, of_residual;
  Field own_weights;
  film::Features estimated;
  std::array<Field, 3> mean, half_difference;  // in windows, own, of the residual
  LightOfSamples light;
};

// The sample of a frame that lies in a pixel of the picture.
struct SampleOfPixel {
  const float* record;
  int pixel;    // of its frame
  float share;  // what the test of light keeps of it
  Vec2 displacement;
};

// A row of the samples of a frame, as they lie in the picture.
class MovedRow {
 public:
  MovedRow(const JoinedFrame& frame, const FrameRecords& picture, int y)
      : records(*frame.records),
        ratio(relative_scale(*frame.records, picture)),
        width_(frame.moved.track.width),
        source_(frame.moved.track.source.data() + size_t(y) * size_t(width_)),
        displacement_(frame.moved.track.displacement.data() + size_t(y) * size_t(width_)),
        kept_(frame.moved.kept.row(y / kChangeCell)),
        depth_ratio_(frame.moved.depth_ratio.row(y / kChangeCell)) {}

  // Returns the sample in pixel x; its record is null if there is none or it does not count.
  SampleOfPixel sample(int x) const {
    if (x + kRecordsAhead < width_) records.prefetch(source_[x + kRecordsAhead]);
    const float kept = kept_[x / kChangeCell];
    if (source_[x] == film::kNoCorrespondence || kept == 0.0f) return {nullptr, -1, 0.0f, {}};
    return {records.at(source_[x]), source_[x], kept, displacement_[x]};
  }
  // Returns the depth that the picture sees in pixel x over that of the frame.
  float depth_ratio(int x) const { return depth_ratio_[x / kChangeCell]; }

  const FrameRecords& records;
  const float ratio;  // the frame's scale in that of the picture

 private:
  int width_;
  const int32_t* source_;
  const Vec2* displacement_;
  const float *kept_, *depth_ratio_;
};

std::vector<MovedRow> rows_of(const std::vector<JoinedFrame>& frames, const FrameRecords& picture, int y) {
  std::vector<MovedRow> rows;
  rows.reserve(frames.size());
  for (const JoinedFrame& frame : frames) rows.emplace_back(frame, picture, y);
  return rows;
}

// Returns the weight of a sample in the means near the centre of its pixel.
float sampled_weight(const SampleOfPixel& sample) {
  return sample.share * nearness(sample.displacement, kReachOfSampled);
}

// Adds a displacement of a sample in pixel (x, y), times its weight, to sums.
void add_displacement(float weight, const Vec2& displacement, int x, int y, Field* sums) {
  const Displacement by = displaced_by(displacement);
  const std::array<float, kDisplacementChannels> values{by.x, by.y, by.xx, by.xy, by.yy};
  for (int c = 0; c < kDisplacementChannels; ++c) sums->row(y, c)[x] += weight * values[size_t(c)];
}

// Returns pointers to the fields of noisy light and of colours of `terms`. `noisy` says which light of the picture's
// own frame has noise.
template <class Terms>
auto fields_of(Terms& terms, const std::vector<bool>& noisy) {
  std::vector<decltype(&terms.colors[0])> fields;
  for (size_t k = 0; k < noisy.size(); ++k) {
    if (noisy[k]) fields.insert(fields.end(), {&terms.light[k].mean, &terms.light[k].half_difference});
  }
  for (auto& color : terms.colors) fields.push_back(&color);
  return fields;
}

// Sums of up to three channels of a pixel with the weights of a JoinedPlane.
class ValueSums {
 public:
  void add(const SampleWeights& weights, int channels, const std::array<float, 3>& values) {
    const std::array<float, 3> by{weights.in_windows, weights.own, weights.of_residual};
    for (size_t k = 0; k < by.size(); ++k) {
      totals_[k] += by[k];
      for (size_t c = 0; c < size_t(channels); ++c) sums_[k][c] += by[k] * values[c];
    }
  }
  float mean(size_t use, size_t channel) const {
    return totals_[use] > 0.0f ? sums_[use][channel] / totals_[use] : 0.0f;
  }

 private:
  std::array<float, 3> totals_{};
  std::array<std::array<float, 3>, 3> sums_{};
};

// Returns a channel of a component, or of the sum of all, in a pixel of a frame.
float sampled_value(const FrameRecords& frame, int component, int pixel, int channel) {
  const size_t begin = component == kAllComponents ? 0 : size_t(component),
               end = component == kAllComponents ? frame.components.size() : begin + 1;
  float sum = 0.0f;
  for (size_t k = begin; k < end; ++k)
    sum += frame.components[k].row(pixel / frame.width, channel)[pixel % frame.width];
  return sum;
}

}  // namespace

JoinedSamples::JoinedSamples(const FrameRecords& here, std::vector<JoinedFrame> others)
    : here_(here), others_(std::move(others)) {}

PictureSamples JoinedSamples::picture(const HalvedImage& image, film::Features* features) const {
  const int w = here_.width, h = here_.height;
  PicturePlanes planes(w, h);
  const float unit = 1.0f / here_.scale;
  const auto add_own = [&](const float* record, PixelSums* sums) {
    sums->add(move_record(record, unit, 1.0f, relative_depth(record[kRecordDepth], here_.typical_depth), {}),
              weigh_sample(record, 1.0f, 1.0f, {}));
  };
  const auto add_other = [&](const MovedRow& row, int x, int y, PixelSums* sums) {
    const SampleOfPixel sample = row.sample(x);
    if (sample.record == nullptr) return;
    const float depth = relative_depth(sample.record[kRecordDepth] * row.depth_ratio(x), here_.typical_depth);
    MovedRecord moved = move_record(sample.record, unit, row.ratio, depth, sample.displacement);
    if (GRADUS_FAULT(moved_halves_dropped)) {
      for (int c = 0; c < 3; ++c)
        moved.low[kRecordHalfDifference + c] = unit * here_.at(y * w + x)[kRecordHalfDifference + c];
    }
    sums->add(moved, weigh_sample(sample.record, row.ratio, sample.share, sample.displacement));
  };
  for_rows(h, [&](int y) {
    const std::vector<MovedRow> rows = rows_of(others_, here_, y);
    for (int x = 0; x < w; ++x) {
      PixelSums sums;
      add_own(here_.at(y * w + x), &sums);
      for (const MovedRow& row : rows) add_other(row, x, y, &sums);
      planes.write(x, y, sums);
    }
  });
  return planes.take(noise_around(image), features);
}

SampledPicture JoinedSamples::sampled(film::Features features, const Field& regressed) const {
  const int w = here_.width, h = here_.height;
  Field light(w, h, kColors), displacements(w, h, kDisplacementChannels);
  for_rows(h, [&](int y) {
    const std::vector<MovedRow> rows = rows_of(others_, here_, y);
    for (int x = 0; x < w; ++x) {
      LightSums sums;
      sums.add(1.0f, load(here_.at(y * w + x)));
      for (const MovedRow& row : rows) {
        const SampleOfPixel sample = row.sample(x);
        if (sample.record == nullptr) continue;
        const float weight = sampled_weight(sample);
        sums.add(weight, load(sample.record));
        add_displacement(weight, sample.displacement, x, y, &displacements);
      }
      const std::array<float, kLanes> means = sums.means();
      put<kColors>(means.data() + kRecordMean, x, y, &light);
      for (int c = 0; c < kDisplacementChannels; ++c) displacements.row(y, c)[x] /= sums.weight();
    }
  });
  if (!GRADUS_FAULT(denoiser_reads_displaced_light)) move_to_centres(regressed, displacements, &light);
  return {interleave(light), std::move(features.albedo.values), std::move(features.normal.values)};
}

SampledTerms JoinedSamples::sampled(SampledTerms own, const std::function<SampledTerms(int number)>& read) const {
  SampledTerms sums = std::move(own);
  std::vector<bool> noisy;
  for (const HalvedImage& image : sums.light) noisy.push_back(!is_black(image.half_difference));
  const std::vector<Field*> fields = fields_of(sums, noisy);
  Field weights = make_field(here_.width, here_.height, [](int, int) { return 1.0f; });
  Field displacements(here_.width, here_.height, kDisplacementChannels);
  for (const JoinedFrame& frame : others_) {
    const SampledTerms terms = read(frame.number);
    if (terms.light.size() != sums.light.size() || terms.colors.size() != sums.colors.size()) continue;
    const std::vector<const Field*> others = fields_of(terms, noisy);
    for_rows(here_.height, [&](int y) {
      const MovedRow row(frame, here_, y);
      for (int x = 0; x < here_.width; ++x) {
        const SampleOfPixel sample = row.sample(x);
        if (sample.record == nullptr) continue;
        const float weight = sampled_weight(sample);
        weights.row(y)[x] += weight;
        add_displacement(weight, sample.displacement, x, y, &displacements);
        const int from_x = sample.pixel % here_.width, from_y = sample.pixel / here_.width;
        for (size_t k = 0; k < fields.size(); ++k) {
          for (int c = 0; c < kColors; ++c) fields[k]->row(y, c)[x] += weight * others[k]->row(from_y, c)[from_x];
        }
      }
    });
  }
  for_values(&weights, [](float& value, int, int, int) { value = 1.0f / value; });
  scale_by(weights, &displacements);
  for (Field* field : fields) scale_by(weights, field);
  // Colours have little noise, so that their own derivatives tell how they change.
  for (Field& color : sums.colors) move_to_centres(Field(color), displacements, &color);
  return sums;
}

JoinedPlane JoinedSamples::join(int component, int first, const Field& own) const {
  const int w = here_.width, h = here_.height, channels = own.channels();
  std::array<Field, 3> joined{Field(w, h, channels), Field(w, h, channels), Field(w, h, channels)};
  for_rows(h, [&](int y) {
    const std::vector<MovedRow> rows = rows_of(others_, here_, y);
    for (int x = 0; x < w; ++x) {
      ValueSums sums;
      std::array<float, 3> values{};
      for (int c = 0; c < channels; ++c) values[size_t(c)] = own.row(y, c)[x];
      sums.add(weigh_sample(here_.at(y * w + x), 1.0f, 1.0f, {}), channels, values);
      for (const MovedRow& row : rows) {
        const SampleOfPixel sample = row.sample(x);
        if (sample.record == nullptr) continue;
        for (int c = 0; c < channels; ++c) {
          values[size_t(c)] = (first + c < kColors ? 1.0f / here_.scale : 1.0f) *
                              sampled_value(row.records, component, sample.pixel, first + c);
        }
        sums.add(weigh_sample(sample.record, row.ratio, sample.share, sample.displacement), channels, values);
      }
      for (size_t use = 0; use < joined.size(); ++use) {
        for (int c = 0; c < channels; ++c) joined[use].row(y, c)[x] = sums.mean(use, size_t(c));
      }
    }
  });
  return {std::make_shared<const Field>(std::move(joined[0])), std::make_shared<const Field>(std::move(joined[1])),
          std::make_shared<const Field>(std::move(joined[2]))};
}

}  // namespace gradus::reconstruct
