#include "reconstruct/space_time/pixel_track.h"

#include <cmath>
#include <numeric>

namespace gradus::reconstruct {
namespace {

PixelTrack empty_track(int width, int height) {
  const size_t pixels = size_t(width) * size_t(height);
  return {width, height, std::vector<int32_t>(pixels, film::kNoCorrespondence), std::vector<Vec2>(pixels)};
}

float squared_length(const Vec2& v) { return v.x * v.x + v.y * v.y; }

// Puts a pixel of the other frame where it lies: at `displacement` from the centre of `pixel`.
void put(int32_t source, int32_t pixel, Vec2 displacement, PixelTrack* track) {
  const float right = std::round(displacement.x), up = std::round(displacement.y);
  const int x = pixel % track->width + int(right), y = pixel / track->width + int(up);
  if (x < 0 || x >= track->width || y < 0 || y >= track->height) return;
  displacement.x -= right;
  displacement.y -= up;
  const size_t to = size_t(y) * size_t(track->width) + size_t(x);
  if (track->source[to] != film::kNoCorrespondence &&
      squared_length(track->displacement[to]) <= squared_length(displacement))
    return;
  track->source[to] = source;
  track->displacement[to] = displacement;
}

Vec2 off_centre(const film::PixelCorrespondence& correspondence, size_t pixel) {
  return correspondence.off_centre.empty() ? Vec2{} : correspondence.off_centre[pixel];
}

}  // namespace

PixelTrack own_pixels(int width, int height) {
  PixelTrack track = empty_track(width, height);
  std::iota(track.source.begin(), track.source.end(), 0);
  return track;
}

PixelTrack moved_on(const PixelTrack& track, const film::PixelCorrespondence& to_previous) {
  PixelTrack moved = empty_track(track.width, track.height);
  for (size_t pixel = 0; pixel < to_previous.pixel.size(); ++pixel) {
    const int32_t before = to_previous.pixel[pixel];
    if (before == film::kNoCorrespondence || track.source[size_t(before)] == film::kNoCorrespondence) continue;
    const Vec2 off = off_centre(to_previous, pixel), at = track.displacement[size_t(before)];
    put(track.source[size_t(before)], int32_t(pixel), {at.x + off.x, at.y + off.y}, &moved);
  }
  return moved;
}

PixelTrack moved_back(const PixelTrack& track, const film::PixelCorrespondence& to_previous) {
  PixelTrack moved = empty_track(track.width, track.height);
  for (size_t pixel = 0; pixel < to_previous.pixel.size(); ++pixel) {
    if (to_previous.pixel[pixel] == film::kNoCorrespondence || track.source[pixel] == film::kNoCorrespondence) continue;
    const Vec2 off = off_centre(to_previous, pixel), at = track.displacement[pixel];
    put(track.source[pixel], to_previous.pixel[pixel], {at.x - off.x, at.y - off.y}, &moved);
  }
  return moved;
}

}  // namespace gradus::reconstruct
