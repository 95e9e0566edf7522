#include "reconstruct/space_time/moved_samples.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/rows.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/displaced.h"
#include "reconstruct/field_values.h"
#include "reconstruct/space_time/light_test.h"

namespace gradus::reconstruct {
namespace {

// Radius, in cells, of the squares in which the mean depth of a frame's samples is compared with that of the picture.
constexpr int kDepthRadius = 1;
// Radius, in pixels, of the squares over which the alpha of the picture is smoothed, to predict how that of samples
// depends on where they lie in their pixels.
constexpr int kAlphaRadius = 1;
// Variance that alpha has without noise, so that differences of less than 0.013 in 6×6 pixels, and of 0.001 in 68×68,
// do not count.
constexpr float kAlphaVariance = 1e-3f;
// Variance of the predicted alpha at edges, as a share of (distance from the centre · range of alpha)².
constexpr float kEdgeVariance = 2.0f;

int cells(int pixels) { return (pixels + kChangeCell - 1) / kChangeCell; }

// Calls compare(y, around) for every row of an image, with the rows around it by channel. Rows of one cell are compared
// one after the other.
template <class Compare>
void compare_rows(const Field& image, const Compare& compare) {
  for_pieces(
      cells(image.height()),
      [&](int begin, int end) {
        std::vector<RowsAround> around(size_t(image.channels()), RowsAround(image.width()));
        for (int y = begin * kChangeCell; y < std::min(image.height(), end * kChangeCell); ++y) {
          for (int c = 0; c < image.channels(); ++c) around[size_t(c)].read(image, y, c);
          compare(y, around);
        }
      },
      16);
}

// Adds row y to the changes between the picture and the samples of the frame (light_test.h), and to the sums of the
// depths there and here. `around` holds the rows of the regressed picture, by colour.
void compare_row(const FrameRecords& frame, const PixelTrack& track, const FrameRecords& here,
                 const std::vector<RowsAround>& around, int y, Field* changes, Field* depths) {
  const int w = track.width;
  const size_t first = size_t(y) * size_t(w);
  const float ratio = relative_scale(frame, here), squared = ratio * ratio, unit = 1.0f / here.scale;
  const int j = y / kChangeCell;
  std::array<float*, kChangeChannels> change;
  for (int c = 0; c < kChangeChannels; ++c) change[size_t(c)] = changes->row(j, c);
  float *there = depths->row(j, 0), *seen = depths->row(j, 1);
  for (int x = 0; x < w; ++x) {
    if (x + kRecordsAhead < w) frame.prefetch(track.source[first + size_t(x + kRecordsAhead)]);
    const int32_t source = track.source[first + size_t(x)];
    if (source == film::kNoCorrespondence) continue;
    const float *a = frame.at(source), *b = here.at(int(first) + x);
    const float of_a = a[kRecordWeight], of_b = squared * b[kRecordWeight], weight = of_a * of_b / (of_a + of_b);
    const Displacement displacement = displaced_by(track.displacement[first + size_t(x)]);
    const int i = x / kChangeCell;
    for (int c = 0; c < 3; ++c) {
      const float expected = around[size_t(c)].change(x, displacement);
      change[size_t(c)][i] += weight * (unit * (a[kRecordMean + c] - b[kRecordMean + c]) - expected);
    }
    change[kChangeVariance][i] += 3.0f * weight * weight * (squared * a[kRecordVariance] + b[kRecordVariance]);
    there[i] += a[kRecordDepth];
    seen[i] += b[kRecordDepth];
  }
}

float alpha_at(const FrameRecords& frame, int x, int y) {
  return frame.alpha[size_t(y) * size_t(frame.width) + size_t(x)].mean;
}

// Returns the range of the alpha of 3×3 pixels.
float range_of_alpha(const FrameRecords& frame, int x, int y) {
  float smallest = alpha_at(frame, x, y), largest = smallest;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, frame.height - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, frame.width - 1); ++i) {
      smallest = std::min(smallest, alpha_at(frame, i, j));
      largest = std::max(largest, alpha_at(frame, i, j));
    }
  }
  return largest - smallest;
}

// Tests the alpha of the samples as if it were light. Objects without light have nothing else that shows a change.
Field same_alpha(const FrameRecords& frame, const PixelTrack& track, const ComparedPicture& picture) {
  Field changes(cells(track.width), cells(track.height), kChangeChannels);
  compare_rows(picture.alpha, [&](int y, const std::vector<RowsAround>& around) {
    float *change = changes.row(y / kChangeCell, 0), *variance = changes.row(y / kChangeCell, kChangeVariance);
    const float* range = picture.range_of_alpha.row(y);
    for (int x = 0; x < track.width; ++x) {
      const size_t pixel = size_t(y) * size_t(track.width) + size_t(x);
      if (track.source[pixel] == film::kNoCorrespondence) continue;
      const AlphaRecord a = frame.alpha[size_t(track.source[pixel])], b = picture.here.alpha[pixel];
      const Displacement by = displaced_by(track.displacement[pixel]);
      change[x / kChangeCell] += a.mean - b.mean - around[0].change(x, by);
      variance[x / kChangeCell] +=
          a.variance + b.variance + kAlphaVariance + kEdgeVariance * (by.xx + by.yy) * range[x] * range[x];
    }
  });
  return same_light(std::move(changes));
}

}  // namespace

ComparedPicture compared_picture(const FrameRecords& here, Field regressed) {
  ComparedPicture picture{here, std::move(regressed)};
  if (here.alpha.empty()) return picture;
  picture.alpha =
      box_mean(make_field(here.width, here.height, [&](int x, int y) { return alpha_at(here, x, y); }), kAlphaRadius);
  picture.range_of_alpha =
      make_field(here.width, here.height, [&](int x, int y) { return range_of_alpha(here, x, y); });
  return picture;
}

MovedSamples move_samples(const FrameRecords& frame, PixelTrack track, const ComparedPicture& picture) {
  const int w = cells(track.width), h = cells(track.height);
  Field changes(w, h, kChangeChannels), depths(w, h, 2);
  compare_rows(picture.regressed, [&](int y, const std::vector<RowsAround>& around) {
    compare_row(frame, track, picture.here, around, y, &changes, &depths);
  });
  Field kept = same_light(std::move(changes));
  if (!picture.here.alpha.empty()) scale_by(same_alpha(frame, track, picture), &kept);
  depths = box_mean(depths, kDepthRadius);
  Field ratio = make_field(w, h, [&](int x, int y) {
    const float there = depths.row(y, 0)[x];
    return there > 0.0f ? depths.row(y, 1)[x] / there : 1.0f;
  });
  return {std::move(track), std::move(kept), std::move(ratio)};
}

}  // namespace gradus::reconstruct
