#include "reconstruct/space_time/moved_samples.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/rows.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/displaced.h"
#include "reconstruct/field_values.h"
#include "reconstruct/space_time/light_test.h"

namespace gradus::reconstruct {
namespace {

// Radius, in cells, of the squares in which the mean depth of a frame's samples is compared with that of the picture.
constexpr int kDepthRadius = 1;

// Adds row y to the changes between the picture and the samples of the frame (light_test.h), and to the sums of the
// depths there and here. `around` holds the rows of the regressed picture, by colour.
void compare_row(const FrameRecords& frame, const PixelTrack& track, const FrameRecords& here,
                 const std::array<RowsAround, kColors>& around, int y, Field* changes, Field* depths) {
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

}  // namespace

MovedSamples move_samples(const FrameRecords& frame, PixelTrack track, const FrameRecords& here,
                          const Field& regressed) {
  const int w = (track.width + kChangeCell - 1) / kChangeCell, h = (track.height + kChangeCell - 1) / kChangeCell;
  Field changes(w, h, kChangeChannels), depths(w, h, 2);
  for_pieces(
      h,
      [&](int begin, int end) {
        std::array<RowsAround, kColors> around{RowsAround(track.width), RowsAround(track.width),
                                               RowsAround(track.width)};
        for (int y = begin * kChangeCell; y < std::min(track.height, end * kChangeCell); ++y) {
          for (int c = 0; c < kColors; ++c) around[size_t(c)].read(regressed, y, c);
          compare_row(frame, track, here, around, y, &changes, &depths);
        }
      },
      16);
  depths = box_mean(depths, kDepthRadius);
  Field ratio = make_field(w, h, [&](int x, int y) {
    const float there = depths.row(y, 0)[x];
    return there > 0.0f ? depths.row(y, 1)[x] / there : 1.0f;
  });
  return {std::move(track), same_light(std::move(changes)), std::move(ratio)};
}

}  // namespace gradus::reconstruct
