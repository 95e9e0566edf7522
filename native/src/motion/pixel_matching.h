// Finds for each pixel the pixel of the next frame that shows the same surface point: the map φ of temporal gradients
// (Manzi et al. 2016, Temporal Gradient-Domain Path Tracing, section 4.2). Temporal gradients only compare the pixels,
// so that a wrong correspondence increases their variance, and nothing else. Samples that REGULARIZED joins along a
// wrong one are dropped if their light differs by more than noise.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "camera/camera.h"
#include "film/film.h"
#include "film/replay_map.h"
#include "scene/snapshot.h"

namespace gradus::motion {

// Camera rays through the pixel centres of a frame, and what they hit, at the time of the frame and through the middle
// of the lens.
struct CentreView {
  const scene::Snapshot* snapshot = nullptr;
  camera::Camera camera;  // at the time of the frame, without a lens
  Region region;
  std::vector<geometry::Hit> hits;  // for each pixel of the region; not valid where the ray leaves the scene
  std::vector<Vec3> directions;     // of the rays
};
// Traces the rays of a view. The snapshot must outlive it. region: part of a film of width × height pixels. After
// cancelling, some hits are missing.
CentreView view_centres(
    const scene::Snapshot& snapshot, uint32_t width, uint32_t height, const Region& region,
    const CancelCheck& is_cancelled = [] { return false; });

// Returns the film position of a pixel's centre. pixel: index in the region.
Vec2 centre_of(const Region& region, size_t pixel);
// Returns the index of the pixel that contains a film position, or kNoCorrespondence outside the region.
int32_t pixel_at(const Region& region, const Vec2& film);

// Returns whether test(other) is true for a pixel beside this one, in its row or column. pixel: index in the region.
template <class Test>
bool any_beside(const Region& region, size_t pixel, const Test& test) {
  const auto width = size_t(region.width()), x = pixel % width;
  return (x > 0 && test(pixel - 1)) || (x + 1 < width && test(pixel + 1)) || (pixel >= width && test(pixel - width)) ||
         (pixel + width < size_t(region.area()) && test(pixel + width));
}

// Returns the offset of a film position from the centre of its pixel, within half a pixel. It is rounded to 1/256
// pixel, so that it is exactly 0 for what does not move.
Vec2 off_centre(const Region& region, size_t pixel, const Vec2& film);

// Returns for each pixel of `from` the corresponding pixel of `to`. The map is one-to-one. A pixel corresponds to
// another only if the motion back leads to within a pixel of it. If several pixels lead to the same one, the nearest to
// the camera gets it. Both views must have the same region.
film::PixelCorrespondence match_pixels(const CentreView& from, const CentreView& to);
// Returns the inverse map: for each pixel of `to` the pixel of `from`.
film::PixelCorrespondence inverse_correspondence(const film::PixelCorrespondence& correspondence);

// Whether there is a shot change between two frames: the camera turns by more than 30°, has another type, or zooms by a
// factor of 1.5 or more.
bool is_shot_change(const GradusCamera& from, const GradusCamera& to);

}  // namespace gradus::motion
