// What shading needs of a scene: its geometry, the materials on it, images, camera and world.
#pragma once

#include <memory>
#include <vector>

#include "geometry/geometry.h"

namespace gradus::image {
class ImageStore;  // image/image_store.h
}  // namespace gradus::image

namespace gradus::shading {

struct MaterialData;  // shading/material.h: compiled node program and flags

// Geometry with materials and images. Functions that run node programs take this part of a snapshot.
class ShadedScene : public geometry::Geometry {
 public:
  std::vector<std::shared_ptr<const MaterialData>> materials;  // 0: the default grey
  std::shared_ptr<const image::ImageStore> images;
  GradusCamera camera{};  // in internal space; its arrays are those of Snapshot::camera_keys
  bool has_camera = false;
  GradusWorld world{};
  uint32_t world_material = UINT32_MAX;
};

}  // namespace gradus::shading
