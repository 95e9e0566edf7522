// The camera maps a film position to a ray at a shutter time. It also projects a world position to the film, at the
// frame's time or at that of the previous or next frame (for motion vectors).
#pragma once

#include <array>

#include "base/types.h"
#include "geometry/matrix_keys.h"
#include "gradus/gradus.h"

namespace gradus::camera {

// The sample that determines a camera ray.
struct CameraSample {
  Vec2 film;               // Pixels of the full film from its lower left corner; pixel centres are at +0.5.
  Vec2 lens = Vec2(0.0f);  // Lens sample in [0, 1)²; pinhole cameras ignore it.
  float time = 0.0f;       // Shutter time, from 0 (opening) to 1 (closing).

  // Returns the sample moved by an offset on the film, in pixels.
  CameraSample moved(const Vec2& by) const { return {film + by, lens, time}; }
};

class Camera {
 public:
  Camera() = default;
  // `desc` is given in the space of the rays, see Snapshot::camera. Matrices that are not invertible become the
  // identity. Throws Error INVALID_ARGUMENT for an invalid number of shutter keys.
  Camera(const GradusCamera& desc, uint32_t width, uint32_t height);

  // Returns the camera ray from clip_start to clip_end, or kNoRay where a panorama's film shows nothing.
  Ray ray(const CameraSample& sample) const;
  // Projects a world position to the film, in pixels. Returns false if it is behind the camera.
  bool project(const Vec3& world, Moment when, Vec2* film) const;
  // Projects a direction at infinity to the film. Returns false if it is not visible.
  bool project_direction(const Vec3& direction, Moment when, Vec2* film) const;
  // Returns the displacement between two film positions, in pixels. On a panorama that wraps around, it is the shorter
  // one.
  Vec2 film_displacement(const Vec2& from, const Vec2& to) const;
  // Returns the depth along the view axis; for a panorama, the distance from the camera.
  float depth(const Vec3& world, float time) const;
  // Returns the rotation from directions of the world to the camera's right, up and view axis, as Cycles has them.
  Mat3 view_rotation() const;
  bool has_lens() const { return desc_.aperture_radius > 0.0f; }
  // Returns this camera as a pinhole camera.
  Camera without_lens() const;
  // Returns a static camera with the pose of this one at a shutter time.
  Camera frozen_at(float time) const;
  bool is_panorama() const { return desc_.type == GRADUS_CAMERA_PANORAMA; }
  // Returns whether the camera moves while the shutter is open.
  bool moves() const { return !keys_.empty(); }
  Vec3 position(float time) const;

 private:
  // The pose and the window at one time.
  struct Pose {
    Mat3 axes{1.0f};  // Camera to world.
    Mat3 inverse{1.0f};
    Vec3 position{0.0f};
    std::array<float, 4> window{-1.0f, 1.0f, -1.0f, 1.0f};
  };
  static Pose make_pose(const float* matrix, const float* window);
  const Pose& pose(Moment when) const { return poses_[static_cast<int>(when)]; }
  // Returns the pose at a shutter time. A static camera returns the frame's pose; otherwise the pose is computed in
  // `room`.
  const Pose& pose_at(float time, Pose* room) const;
  void add_keys();
  // Returns whether the camera is one of two eyes beside the centre, for spherical stereo.
  bool has_eye() const { return desc_.eye_offset != 0.0f; }
  Vec2 lens_point(const Vec2& u) const;
  Ray panorama_ray(const Pose& pose, const Vec2& point, const CameraSample& sample) const;
  // Returns the axis of the circle of the two eyes, in camera space.
  Vec3 stereo_axis(const Pose& pose) const;
  bool panorama_plane(const Pose& pose, const Vec3& local, Vec2* point) const;
  // Projects `local`, in camera space, to the film. It is a direction if `at_infinity` is true.
  bool to_film(const Pose& pose, Vec3 local, bool at_infinity, Vec2* film) const;

  GradusCamera desc_{};
  std::array<Pose, 3> poses_;
  geometry::MatrixKeys keys_;                  // Poses over the shutter interval; empty for a static camera.
  std::vector<std::array<float, 4>> windows_;  // Window of each key; empty: the frame's window.
  uint32_t width_ = 0;
  uint32_t height_ = 0;
};

}  // namespace gradus::camera
