// Which pixel of the next frame shows what a pixel shows: the map φ of temporal gradients (Manzi et al. 2016, Temporal
// Gradient-Domain Path Tracing, section 4.2). It decides who is compared with whom, nothing else: a wrong link costs
// variance, never the right result.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "camera/camera.h"
#include "film/film.h"
#include "film/pixel_correspondence.h"
#include "scene/snapshot.h"

namespace gradus::motion {

// A frame as its pixel centres see it, at the moment of the frame and through the middle of the lens.
struct CentreView {
  const scene::Snapshot* snapshot = nullptr;
  camera::Camera camera;  // of that moment
  Region region;
  std::vector<geometry::Hit> hits;  // by pixels of the region; not valid: the ray left the scene
  std::vector<Vec3> directions;     // of the rays
};
// The snapshot lives as long as the view; the region is one of a film of width × height. Cancelled: some of its pixels
// see nothing.
CentreView view_centres(
    const scene::Snapshot& snapshot, uint32_t width, uint32_t height, const Region& region,
    const CancelCheck& is_cancelled = [] { return false; });

// Middle of a pixel of the region.
Vec2 centre_of(const Region& region, size_t pixel);
// The pixel of the region that holds a film position; kNoCorrespondence outside.
int32_t pixel_at(const Region& region, const Vec2& film);

// How far a film position lies from the middle of its pixel, in steps that leave what rests exactly there.
Vec2 off_centre(const Region& region, size_t pixel, const Vec2& film);

// By pixels of `from`: the pixel of `to`. One-to-one. A link leads back to within a pixel of where it came from; of
// several pixels that lead to one the nearest to the camera has it. Both views have the same region.
film::PixelCorrespondence match_pixels(const CentreView& from, const CentreView& to);
// The other way round: by pixels of `to`, the pixel of `from`.
film::PixelCorrespondence inverse_correspondence(const film::PixelCorrespondence& correspondence);

// Whether the film or the view changes so much between two frames that they are no motion but a cut (test C8: a turn of
// more than 30°, another type of camera, a jump of the zoom).
bool is_shot_change(const GradusCamera& from, const GradusCamera& to);

}  // namespace gradus::motion
