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

// Pixels without a link are taken to be like those around them: 0 would tell their neighbours that nothing changes. linked: 0 or 1.
void fill_holes(const Field& linked, HalvedImage* image) {
  const Field around = box_mean(linked, kHoleRadius), mean = box_mean(image->mean, kHoleRadius),
              squares = box_mean(square(image->half_difference), kHoleRadius);
  const auto fill = [&](Field* field, const auto& of_linked) {
    for_values(field, [&](float& value, int x, int y, int c) {
      if (linked.row(y)[x] == 0.0f) value = around.row(y)[x] > 0.0f ? of_linked(x, y, c) : 0.0f;
    });
  };
  fill(&image->mean, [&](int x, int y, int c) { return mean.row(y, c)[x] / around.row(y)[x]; });
  fill(&image->half_difference, [&](int x, int y, int c) { return std::sqrt(squares.row(y, c)[x] / around.row(y)[x]); });
}

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
  fill_holes(linked_pixels(change.links), &image);
  const FeatureRegression regression(features, image, cancel);
  const Field alpha = size.channels > 3 ? regression.apply(read_channels(size, 3, 1, values), cancel) : Field();
  for_values(&change.difference,
             [&](float& value, int x, int y, int c) { value = c < 3 ? scale * regression.image().row(y, c)[x] : alpha.row(y)[x]; });
  for_values(&change.weight, [&](float& value, int x, int y, int) {
    value = track_weight(scale * scale * (kTimesError * regression.error().row(y)[x] + kLeastError));
  });
  return change;
}

}  // namespace gradus
