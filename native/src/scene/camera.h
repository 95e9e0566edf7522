// Camera: film position to ray, and world position to film, at the frame's time or one frame before or after (for vectors).
#pragma once

#include <array>

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus {

enum class Shutter { Now, Previous, Next };

class Camera {
 public:
  Camera() = default;
  // Matrices that cannot be inverted become the identity. desc: in the space of the rays wanted, see Snapshot::camera.
  Camera(const GradusCamera& desc, uint32_t width, uint32_t height);

  // film: pixels of the full frame, origin at the lower left corner, pixel centres at +0.5. lens: [0,1)², ignored by pinholes.
  // The segment starts at clip_start and ends at clip_end. None where a panorama's film sees nothing.
  Ray ray(const Vec2& film, const Vec2& lens) const;
  // Where a world point appears, in pixels; false behind the camera.
  bool project(const Vec3& world, Shutter when, Vec2* film) const;
  // Where a direction at infinity appears.
  bool project_direction(const Vec3& direction, Shutter when, Vec2* film) const;
  // From where a point appears to where another does, in pixels: the shortest way, where the film comes back to its beginning.
  Vec2 way(const Vec2& from, const Vec2& to) const;
  // Planar distance along the view axis; panorama: distance.
  float depth(const Vec3& world) const;
  bool has_lens() const { return desc_.aperture_radius > 0.0f; }
  bool is_panorama() const { return desc_.type == GRADUS_CAMERA_PANORAMA; }
  Vec3 position() const;
  Vec3 forward() const;

 private:
  // Pose and window at one time.
  struct Pose {
    Mat3 axes{1.0f};  // camera to world
    Mat3 inverse{1.0f};
    Vec3 position{0.0f};
    std::array<float, 4> window{-1.0f, 1.0f, -1.0f, 1.0f};
  };
  static Pose make_pose(const float* matrix, const float* window);
  const Pose& pose(Shutter when) const { return poses_[static_cast<int>(when)]; }
  // One of two that lie beside the centre, for spherical stereo.
  bool has_eye() const { return desc_.eye_offset != 0.0f; }
  Vec2 lens_point(const Vec2& u) const;
  Ray panorama_ray(const Pose& pose, const Vec2& point, const Vec2& lens) const;
  // In camera space.
  Vec3 stereo_axis(const Pose& pose) const;
  bool panorama_plane(const Pose& pose, const Vec3& local, Vec2* point) const;
  // at_infinity: local is a direction.
  bool to_film(const Pose& pose, Vec3 local, bool at_infinity, Vec2* film) const;

  GradusCamera desc_{};
  std::array<Pose, 3> poses_;
  uint32_t width_ = 0;
  uint32_t height_ = 0;
};

}  // namespace gradus
