// Camera: film position to ray, while the shutter is open; and world position to film, at the frame or one before or
// after (for vectors).
#pragma once

#include <array>

#include "base/types.h"
#include "geometry/matrix_keys.h"
#include "gradus/gradus.h"

namespace gradus::camera {

// What a camera ray is a function of.
struct CameraSample {
  Vec2 film;               // pixels of the full frame, origin at the lower left corner, pixel centres at +0.5
  Vec2 lens = Vec2(0.0f);  // [0,1)², ignored by pinholes
  float time = 0.0f;       // of the shutter

  // At another place of the film.
  CameraSample moved(const Vec2& by) const { return {film + by, lens, time}; }
};

class Camera {
 public:
  Camera() = default;
  // Matrices that cannot be inverted become the identity. desc: in the space of the rays wanted, see Snapshot::camera.
  Camera(const GradusCamera& desc, uint32_t width, uint32_t height);

  // The segment starts at clip_start and ends at clip_end. None where a panorama's film sees nothing.
  Ray ray(const CameraSample& sample) const;
  // Where a world point appears, in pixels; false behind the camera.
  bool project(const Vec3& world, Moment when, Vec2* film) const;
  // Where a direction at infinity appears.
  bool project_direction(const Vec3& direction, Moment when, Vec2* film) const;
  // From where a point appears to where another does, in pixels: the shortest way, where the film comes back to its
  // beginning.
  Vec2 film_displacement(const Vec2& from, const Vec2& to) const;
  // Planar distance along the view axis; panorama: distance.
  float depth(const Vec3& world, float time) const;
  bool has_lens() const { return desc_.aperture_radius > 0.0f; }
  // The same, with a point for a lens.
  Camera without_lens() const;
  // The same, held where it is at a time of the shutter.
  Camera frozen_at(float time) const;
  bool is_panorama() const { return desc_.type == GRADUS_CAMERA_PANORAMA; }
  // It moves while the shutter is open.
  bool moves() const { return !keys_.empty(); }
  Vec3 position(float time) const;

 private:
  // Pose and window at one time.
  struct Pose {
    Mat3 axes{1.0f};  // camera to world
    Mat3 inverse{1.0f};
    Vec3 position{0.0f};
    std::array<float, 4> window{-1.0f, 1.0f, -1.0f, 1.0f};
  };
  static Pose make_pose(const float* matrix, const float* window);
  const Pose& pose(Moment when) const { return poses_[static_cast<int>(when)]; }
  // The pose at a time of the shutter: the frame's where the camera is at rest, otherwise put into `room`.
  const Pose& pose_at(float time, Pose* room) const;
  void add_keys();
  // One of two that lie beside the centre, for spherical stereo.
  bool has_eye() const { return desc_.eye_offset != 0.0f; }
  Vec2 lens_point(const Vec2& u) const;
  Ray panorama_ray(const Pose& pose, const Vec2& point, const CameraSample& sample) const;
  // In camera space.
  Vec3 stereo_axis(const Pose& pose) const;
  bool panorama_plane(const Pose& pose, const Vec3& local, Vec2* point) const;
  // at_infinity: local is a direction.
  bool to_film(const Pose& pose, Vec3 local, bool at_infinity, Vec2* film) const;

  GradusCamera desc_{};
  std::array<Pose, 3> poses_;
  geometry::MatrixKeys keys_;                  // while the shutter is open; empty: at rest
  std::vector<std::array<float, 4>> windows_;  // with its own keys; empty: as in the frame
  uint32_t width_ = 0;
  uint32_t height_ = 0;
};

}  // namespace gradus::camera
