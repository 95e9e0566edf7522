#include "reconstruct/space_time/regress_change.h"

#include <cmath>

#include "base/fault.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/linear_terms.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/space_time/rounded_displacements.h"
#include "reconstruct/space_time/solve_tracks.h"

namespace gradus::reconstruct {
namespace {

// Factor of the regression's squared error. Errors are similar in neighbouring pixels, but differ from one frame to the
// next: docs/method.md.
constexpr float kTimesError = 2.0f;
// Minimum of the squared error, in units of the squared median luminance.
constexpr float kMinChangeError = 1e-8f;
// Radius of the window from which pixels without a correspondence are filled.
constexpr int kDisocclusionRadius = 7;

// Reads the channels [first, first + channels) of an image by rows. Values that are not finite become 0.
template <class ReadRow>
Field read_channels(const WindowSize& size, int first, int channels, const ReadRow& read_row) {
  Field field(size.width, size.height, channels);
  for_pieces(size.height, [&](int begin, int end) {
    std::vector<float> row(size_t(size.width) * size_t(size.channels));
    for (int y = begin; y < end; ++y) {
      read_row(y, row.data());
      for (int c = 0; c < channels; ++c) {
        for (int x = 0; x < size.width; ++x) {
          const float value = row[size_t(x) * size_t(size.channels) + size_t(first + c)];
          field.row(y, c)[x] = is_finite(value) ? value : 0.0f;
        }
      }
    }
  });
  return field;
}

Field square(Field field) {
  for_values(&field, [](float& value, int, int, int) { value *= value; });
  return field;
}

// Fills pixels without a correspondence from the pixels around them. The regression would take a change of 0 for a
// static pixel.
class DisocclusionFiller {
 public:
  // `mask` is 1 for pixels with a correspondence and 0 for others.
  explicit DisocclusionFiller(Field mask) : mask_(std::move(mask)), around_(box_mean(mask_, kDisocclusionRadius)) {}

  // The filled field must be 0 in pixels without a correspondence.
  void fill_with_mean(Field* field) const { fill(field, box_mean(*field, kDisocclusionRadius), identity); }
  void fill_with_rms(Field* field) const { fill(field, box_mean(square(*field), kDisocclusionRadius), root); }

 private:
  static float identity(float value) { return value; }
  static float root(float value) { return std::sqrt(value); }

  void fill(Field* field, const Field& means, float (*function)(float)) const {
    for_values(field, [&](float& value, int x, int y, int c) {
      const float around = around_.row(y)[x];
      if (mask_.row(y)[x] == 0.0f) value = around > 0.0f ? function(means.row(y, c)[x] / around) : 0.0f;
    });
  }

  Field mask_, around_;
};

Field corresponding_pixels(const CorrespondenceMap& correspondence) {
  return make_field(correspondence.width(), correspondence.height(),
                    [&](int x, int y) { return correspondence.row(y)[x] == CorrespondenceMap::kNone ? 0.0f : 1.0f; });
}

// The sampled change of one component. Colours are in units of the median luminance.
struct ComponentChange {
  HalvedImage image;
  Field alpha;  // empty if the component has three channels
};

// Reads the change of a component and subtracts the part that comes from rounding its correspondence to whole pixels.
ComponentChange read_change(const HalvedWindowSource& source, int t, const CorrespondenceMap& correspondence,
                            Field* rounding, float scale) {
  const WindowSize size = source.size();
  const auto values = [&](int y, float* row) { source.read_row(RowKind::kDt, t, y, row); };
  const auto halves = [&](int y, float* row) { source.read_half_differences(RowKind::kDt, t, y, row); };
  ComponentChange change{{read_channels(size, 0, 3, values), read_channels(size, 0, 3, halves), false}, {}};
  if (!GRADUS_FAULT(rounding_included_without_samples)) keep_sampled_share(change.image.mean, rounding);
  for_values(&change.image.mean, [&](float& value, int x, int y, int c) { value -= rounding->row(y, c)[x]; });
  normalise(scale, &change.image);
  const DisocclusionFiller filler(corresponding_pixels(correspondence));
  filler.fill_with_mean(&change.image.mean);
  filler.fill_with_rms(&change.image.half_difference);
  if (size.channels > 3) {
    change.alpha = read_channels(size, 3, 1, values);
    for_values(&change.alpha, [&](float& value, int x, int y, int) { value -= rounding->row(y, 3)[x]; });
    filler.fill_with_mean(&change.alpha);
  }
  return change;
}

// Joins colours and alpha in the units of the picture, and adds the change that comes from rounding.
Field join(const Field& colours, const Field& alpha, const Field& rounding, float scale) {
  Field joined(colours.width(), colours.height(), alpha.width() > 0 ? 4 : 3);
  for_values(&joined, [&](float& value, int x, int y, int c) {
    value = (c < 3 ? scale * colours.row(y, c)[x] : alpha.row(y)[x]) +
            (GRADUS_FAULT(rounding_left_out_of_change) ? 0.0f : rounding.row(y, c)[x]);
  });
  return joined;
}

}  // namespace

Change regress_change(const ComponentSources& components, int t, const std::vector<Field>& pictures,
                      const film::Features& features, float scale, const CancelCheck& cancel) {
  Change change;
  HalvedImage sum;
  std::vector<Field> colours, alphas, roundings;
  for (size_t k = 0; k < components.size(); ++k) {
    change.correspondence.push_back(read_correspondence(*components[k], t));
    roundings.push_back(rounding_change(pictures[k], change.correspondence[k], *components[k], t));
    ComponentChange component = read_change(*components[k], t, change.correspondence[k], &roundings[k], scale);
    colours.push_back(component.image.mean);
    alphas.push_back(std::move(component.alpha));
    if (colours.size() == 1) {
      sum = std::move(component.image);
    } else {
      add(component.image.mean, &sum.mean);
      if (!GRADUS_FAULT(component_changes_not_added)) add(component.image.half_difference, &sum.half_difference);
    }
  }
  const FeatureRegression regression(features, sum, cancel);
  apply_to_terms(
      regression.image(), [&](size_t, const Field& part) { return regression.apply(part, cancel); }, &colours);
  for (size_t k = 0; k < components.size(); ++k) {
    if (alphas[k].width() > 0 && !is_black(alphas[k])) alphas[k] = regression.apply(alphas[k], cancel);
    change.difference.push_back(join(colours[k], alphas[k], roundings[k], scale));
  }
  change.weight = make_field(sum.mean.width(), sum.mean.height(), [&](int x, int y) {
    return track_weight(scale * scale * (kTimesError * regression.error().row(y)[x] + kMinChangeError));
  });
  return change;
}

}  // namespace gradus::reconstruct
