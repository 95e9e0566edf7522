#include "motion/pixel_matching.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "base/fault.h"
#include "motion/snapshot_motion.h"
#include "path/context.h"

namespace gradus::motion {

namespace {

constexpr float kLargestReturn = 1.0f;  // pixels, in x and in y
const float kShotChangeCosine = std::cos(kPi / 6.0f);
constexpr float kShotChangeZoom = 1.5f;
constexpr float kStepsOfPixel = 256.0f;

// Position of what a pixel shows in the other frame, and its distance from the camera.
struct TrackedPixel {
  Vec2 film{0.0f};
  float distance = kInfinity;
  bool found = false;
};

// Follows what pixels of one view show to the film of another.
class PixelTracker {
 public:
  PixelTracker(const CentreView& from, const CentreView& to)
      : from_(from), to_(to), motion_(*from.snapshot, *to.snapshot) {}

  TrackedPixel track(size_t pixel) const {
    TrackedPixel tracked;
    const geometry::Hit& hit = from_.hits[pixel];
    if (!hit.valid()) {
      tracked.film = centre_of(from_.region, pixel);
      tracked.found =
          shows_one_direction() || to_.camera.project_direction(from_.directions[pixel], Moment::Now, &tracked.film);
      return tracked;
    }
    Vec3 position;
    if (!motion_.position(hit, &position)) return tracked;
    tracked.found = to_.camera.project(position, Moment::Now, &tracked.film);
    tracked.distance = glm::length(position - to_.camera.position(0.0f));
    return tracked;
  }

 private:
  // Whether all pixels see the sky in the same direction, so that it does not move on the film.
  bool shows_one_direction() const { return to_.snapshot->camera.type == GRADUS_CAMERA_ORTHOGRAPHIC; }

  const CentreView &from_, &to_;
  SnapshotMotion motion_;
};

// Whether the motion of pixel `next` of the other frame leads back to within kLargestReturn of a pixel.
bool returns(const PixelTracker& back, const CentreView& from, size_t pixel, int32_t next) {
  const TrackedPixel tracked = back.track(size_t(next));
  const Vec2 away = glm::abs(from.camera.film_displacement(centre_of(from.region, pixel), tracked.film));
  return tracked.found && away.x <= kLargestReturn && away.y <= kLargestReturn;
}

template <class Body>
void for_each_pixel(size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 4096), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

}  // namespace

Vec2 centre_of(const Region& region, size_t pixel) {
  const auto width = size_t(region.width());
  return path::pixel_centre(region.x0 + int32_t(pixel % width), region.y0 + int32_t(pixel / width));
}

Vec2 off_centre(const Region& region, size_t pixel, const Vec2& film) {
  return glm::round(glm::clamp(film - centre_of(region, pixel), -0.5f, 0.5f) * kStepsOfPixel) / kStepsOfPixel;
}

int32_t pixel_at(const Region& region, const Vec2& film) {
  const float x = std::floor(film.x), y = std::floor(film.y);
  const bool inside = x >= float(region.x0) && x < float(region.x1) && y >= float(region.y0) && y < float(region.y1);
  if (!inside) return film::kNoCorrespondence;
  return (int32_t(y) - region.y0) * region.width() + (int32_t(x) - region.x0);
}

CentreView view_centres(const scene::Snapshot& snapshot, uint32_t width, uint32_t height, const Region& region,
                        const CancelCheck& is_cancelled) {
  const auto pixels = size_t(region.area());
  const float time = snapshot.shutter.time_of_frame();
  const camera::Camera camera = camera::Camera(snapshot.camera, width, height).frozen_at(time).without_lens();
  CentreView view{&snapshot, camera, region, std::vector<geometry::Hit>(pixels), std::vector<Vec3>(pixels)};
  for_each_pixel(view.hits.size(), [&](size_t i) {
    if (is_cancelled()) return;
    const Ray ray = view.camera.ray({centre_of(region, i), Vec2(0.0f), time});
    view.directions[i] = ray.direction;
    snapshot.intersect(ray, GRADUS_VISIBLE_CAMERA, &view.hits[i]);
  });
  return view;
}

film::PixelCorrespondence match_pixels(const CentreView& from, const CentreView& to) {
  const PixelTracker forward(from, to), back(to, from);
  film::PixelCorrespondence found{std::vector<int32_t>(from.hits.size(), film::kNoCorrespondence),
                                  std::vector<Vec2>(from.hits.size(), Vec2(0.0f))};
  std::vector<int32_t>& correspondence = found.pixel;
  std::vector<float> distances(from.hits.size(), kInfinity);
  for_each_pixel(correspondence.size(), [&](size_t i) {
    const TrackedPixel tracked = forward.track(i);
    const int32_t next = tracked.found ? pixel_at(to.region, tracked.film) : film::kNoCorrespondence;
    if (next == film::kNoCorrespondence) return;
    if (!GRADUS_FAULT(match_need_not_lead_back) && !returns(back, from, i, next)) return;
    correspondence[i] = next;
    found.off_centre[i] = off_centre(to.region, size_t(next), tracked.film);
    distances[i] = tracked.distance;
  });
  // Serial and in the order of pixels, so that ties are decided alike for any number of threads.
  std::vector<int32_t> owner(to.hits.size(), film::kNoCorrespondence);
  for (size_t i = 0; i < correspondence.size(); ++i) {
    if (correspondence[i] == film::kNoCorrespondence) continue;
    int32_t& other = owner[size_t(correspondence[i])];
    const bool nearest = other == film::kNoCorrespondence ||
                         (distances[i] < distances[size_t(other)]) != GRADUS_FAULT(farther_pixel_keeps_match);
    if (nearest && other != film::kNoCorrespondence) correspondence[size_t(other)] = film::kNoCorrespondence;
    if (nearest) other = int32_t(i);
    if (!nearest && !GRADUS_FAULT(two_pixels_match_one)) correspondence[i] = film::kNoCorrespondence;
  }
  return found;
}

film::PixelCorrespondence inverse_correspondence(const film::PixelCorrespondence& correspondence) {
  film::PixelCorrespondence inverse{std::vector<int32_t>(correspondence.pixel.size(), film::kNoCorrespondence),
                                    std::vector<Vec2>(correspondence.off_centre.size(), Vec2(0.0f))};
  for (size_t i = 0; i < correspondence.pixel.size(); ++i) {
    if (correspondence.pixel[i] == film::kNoCorrespondence) continue;
    const auto end = size_t(correspondence.pixel[i]);
    inverse.pixel[end] = int32_t(i);
    if (!correspondence.off_centre.empty() && !GRADUS_FAULT(inverse_ends_in_pixel_centres))
      inverse.off_centre[end] = correspondence.off_centre[i];
  }
  return inverse;
}

bool is_shot_change(const GradusCamera& from, const GradusCamera& to) {
  if (from.type != to.type) return true;
  const auto axis = [](const GradusCamera& c) { return glm::normalize(-Vec3(c.matrix[8], c.matrix[9], c.matrix[10])); };
  const float zoom = (to.window[1] - to.window[0]) / (from.window[1] - from.window[0]);
  const bool zooms =
      !(zoom < kShotChangeZoom && zoom > 1.0f / kShotChangeZoom) && !GRADUS_FAULT(zoom_is_no_shot_change);
  return zooms || !(glm::dot(axis(from), axis(to)) >= kShotChangeCosine);
}

}  // namespace gradus::motion
