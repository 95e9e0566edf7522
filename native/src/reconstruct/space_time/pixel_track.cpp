#include "reconstruct/space_time/pixel_track.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "base/fault.h"
#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

// Number of rows that one thread extends. A pixel moves by at most one row.
constexpr int kBand = 32;
// A surface is nearer than another one if its distance is smaller by more than this share.
constexpr float kNearer = 0.01f;
// Adjacent pixels whose sources are further apart than this, in pixels, move in different ways.
constexpr int kMovesApart = 1;

PixelTrack empty_track(int width, int height) {
  const size_t pixels = size_t(width) * size_t(height);
  return {width, height, std::vector<int32_t>(pixels, film::kNoCorrespondence), std::vector<Vec2>(pixels)};
}

float squared_length(const Vec2& v) { return v.x * v.x + v.y * v.y; }

// Returns the number of whole pixels in a displacement of at most one pixel.
int whole_pixels(float displacement) { return displacement > 0.5f ? 1 : displacement < -0.5f ? -1 : 0; }

// Distances of 0 are those of the sky, which is behind everything.
bool is_nearer(float depth, float other) { return depth > 0.0f && (other <= 0.0f || depth < (1.0f - kNearer) * other); }

// Returns whether pixel `to`, (right, up) from pixel `from`, hides what `from` shows and motion leads into it. It does
// so if it shows a nearer surface that moves in another way, or has none to follow.
bool hides(const PixelTrack& track, const FrameRecords& picture, size_t from, size_t to, int right, int up) {
  if (GRADUS_FAULT(hidden_samples_kept)) return false;
  if (!is_nearer(picture.at(int(to))[kRecordDepth], picture.at(int(from))[kRecordDepth])) return false;
  const int32_t source = track.source[to], beside = track.source[from];
  if (source == film::kNoCorrespondence) return true;
  const int apart_x = source % track.width - beside % track.width - right,
            apart_y = source / track.width - beside / track.width - up;
  return std::max(std::abs(apart_x), std::abs(apart_y)) > kMovesApart;
}

// Puts a pixel of the other frame where it lies: at `displacement` from the centre of pixel (x, y) of a track.
void put(const PixelTrack& track, const FrameRecords& picture, int32_t source, int x, int y, Vec2 displacement,
         PixelTrack* result) {
  const size_t from = size_t(y) * size_t(track.width) + size_t(x);
  const int right = whole_pixels(displacement.x), up = whole_pixels(displacement.y);
  x += right;
  y += up;
  if (x < 0 || x >= track.width || y < 0 || y >= track.height) return;
  displacement.x -= float(right);
  displacement.y -= float(up);
  const size_t to = size_t(y) * size_t(track.width) + size_t(x);
  if (to != from && hides(track, picture, from, to, right, up)) return;
  if (result->source[to] != film::kNoCorrespondence &&
      squared_length(result->displacement[to]) <= squared_length(displacement))
    return;
  result->source[to] = source;
  result->displacement[to] = displacement;
}

Vec2 off_centre(const film::PixelCorrespondence& correspondence, size_t pixel) {
  return correspondence.off_centre.empty() ? Vec2{} : correspondence.off_centre[pixel];
}

void extend_row(const PixelTrack& track, const film::PixelCorrespondence& correspondence, const FrameRecords& picture,
                int y, PixelTrack* result) {
  for (int x = 0; x < track.width; ++x) {
    const size_t pixel = size_t(y) * size_t(track.width) + size_t(x);
    if (track.source[pixel] == film::kNoCorrespondence) continue;
    const auto there = size_t(track.source[pixel]);
    const int32_t source = correspondence.pixel[there];
    if (source == film::kNoCorrespondence) continue;
    const Vec2 off = off_centre(correspondence, there), at = track.displacement[pixel];
    put(track, picture, source, x, y, {at.x + off.x, at.y + off.y}, result);
  }
}

}  // namespace

PixelTrack own_pixels(int width, int height) {
  PixelTrack track = empty_track(width, height);
  std::iota(track.source.begin(), track.source.end(), 0);
  return track;
}

PixelTrack extended(const PixelTrack& track, const film::PixelCorrespondence& correspondence,
                    const FrameRecords& picture) {
  PixelTrack result = empty_track(track.width, track.height);
  if (correspondence.empty()) return result;
  const int bands = (track.height + kBand - 1) / kBand;
  // Adjacent bands put pixels in the same rows, so that every other band runs at a time.
  for (const int parity : {0, 1}) {
    for_rows((bands + 1 - parity) / 2,
             [&](int i) {
               const int first = (2 * i + parity) * kBand;
               for (int y = first; y < std::min(first + kBand, track.height); ++y)
                 extend_row(track, correspondence, picture, y, &result);
             },
             1);
  }
  return result;
}

film::PixelCorrespondence inverse(const film::PixelCorrespondence& to_previous) {
  const size_t pixels = to_previous.pixel.size();
  film::PixelCorrespondence to_next{std::vector<int32_t>(pixels, film::kNoCorrespondence), std::vector<Vec2>(pixels)};
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    const int32_t before = to_previous.pixel[pixel];
    if (before == film::kNoCorrespondence) continue;
    const Vec2 off = off_centre(to_previous, pixel);
    int32_t& known = to_next.pixel[size_t(before)];
    if (known != film::kNoCorrespondence && squared_length(to_next.off_centre[size_t(before)]) <= squared_length(off))
      continue;
    known = int32_t(pixel);
    to_next.off_centre[size_t(before)] = {-off.x, -off.y};
  }
  return to_next;
}

}  // namespace gradus::reconstruct
