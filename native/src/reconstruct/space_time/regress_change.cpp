#include "reconstruct/space_time/regress_change.h"

#include <cmath>

#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/feature_regression.h"
#include "reconstruct/field_values.h"
#include "reconstruct/space_time/solve_tracks.h"

namespace gradus {
namespace {

// Errors are alike in neighbours, and differ from one frame to the next: docs/method.md.
constexpr float kTimesError = 2.0f;
// Squared error of what shows none, in median luminances.
constexpr float kLeastError = 1e-8f;
constexpr int kHoleRadius = 7;

// Channels [first, first + channels) of frame t's rows in time; 0 where there are none.
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

// Pixels without a link are taken to be like those around them: 0 would tell their neighbours that nothing changes.
class HoleFiller {
 public:
  // linked: 0 or 1.
  explicit HoleFiller(Field linked) : linked_(std::move(linked)), around_(box_mean(linked_, kHoleRadius)) {}

  // Of fields that are 0 in holes.
  void fill_with_mean(Field* field) const { fill(field, box_mean(*field, kHoleRadius), identity); }
  void fill_with_rms(Field* field) const { fill(field, box_mean(square(*field), kHoleRadius), root); }

 private:
  static float identity(float value) { return value; }
  static float root(float value) { return std::sqrt(value); }

  void fill(Field* field, const Field& means, float (*function)(float)) const {
    for_values(field, [&](float& value, int x, int y, int c) {
      const float around = around_.row(y)[x];
      if (linked_.row(y)[x] == 0.0f) value = around > 0.0f ? function(means.row(y, c)[x] / around) : 0.0f;
    });
  }

  Field linked_, around_;
};

Field linked_pixels(const Links& links) {
  return make_field(links.width(), links.height(), [&](int x, int y) { return links.row(y)[x] == Links::kNone ? 0.0f : 1.0f; });
}

}  // namespace

Change regress_change(const HalvedWindowSource& source, int t, const Features& features, float scale, const CancelTest& cancel) {
  const WindowSize size = source.size();
  Change change{read_links(source, t), Field(size.width, size.height, size.channels), Field(size.width, size.height, 1)};
  const auto values = [&](int y, float* row) { source.read_row(RowKind::kDt, t, y, row); };
  const auto halves = [&](int y, float* row) { source.read_half_differences(RowKind::kDt, t, y, row); };
  HalvedImage image{read_channels(size, 0, 3, values), read_channels(size, 0, 3, halves), false};
  normalise(scale, &image);
  const HoleFiller holes(linked_pixels(change.links));
  holes.fill_with_mean(&image.mean);
  holes.fill_with_rms(&image.half_difference);
  const FeatureRegression regression(features, image, cancel);
  Field alpha;
  if (size.channels > 3) {
    alpha = read_channels(size, 3, 1, values);
    holes.fill_with_mean(&alpha);
    alpha = regression.apply(alpha, cancel);
  }
  for_values(&change.difference,
             [&](float& value, int x, int y, int c) { value = c < 3 ? scale * regression.image().row(y, c)[x] : alpha.row(y)[x]; });
  for_values(&change.weight, [&](float& value, int x, int y, int) {
    value = track_weight(scale * scale * (kTimesError * regression.error().row(y)[x] + kLeastError));
  });
  return change;
}

}  // namespace gradus
