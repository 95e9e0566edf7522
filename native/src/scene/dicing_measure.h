// How long the edges of a mesh are in the picture.
#pragma once

#include <vector>

#include "scene/snapshot.h"

namespace gradus::scene {

// Measures lengths in internal space by the picture of a camera.
class PictureScale {
 public:
  explicit PictureScale(const GradusCamera& camera);

  // Returns the length at a point that spans the width of the picture. Beyond the borders it grows with the distance
  // from what the camera sees, `offscreen_scale` times as fast as away from the camera. Points behind a camera are
  // beyond the borders. Source: Cycles.
  float width_at(const Vec3& point, float offscreen_scale) const;
  // Returns by how much width_at() can change between points at a distance of 1.
  float slope(float offscreen_scale) const;

 private:
  struct Border {
    Vec3 outwards, along;  // unit vectors across and along a side of the pyramid of view
  };

  float distance_outside(const Vec3& p) const;

  const GradusCamera& camera_;
  Mat4 to_camera_;
  std::array<Border, 4> borders_;  // of a perspective camera
  float per_metre_ = 0.0f;         // width of the picture at a distance of 1, or of an orthographic one
};

// Measures the edges of one mesh by the instance that needs the shortest ones.
class EdgeMeasure {
 public:
  EdgeMeasure(const PictureScale& scale, const geometry::MeshData& mesh,
              const std::vector<const geometry::InstanceData*>& instances);

  // Returns by how many times the edge between two points of the mesh is too long.
  float excess(const Vec3& a, const Vec3& b) const;

 private:
  const PictureScale& scale_;
  float rate_, length_, offscreen_scale_;
  std::vector<Mat4> to_world_;  // of the instances that may need the shortest edges
};

}  // namespace gradus::scene
