// The data of a scene that shading reads: geometry, materials, images, camera and world.
#pragma once

#include <memory>
#include <vector>

#include "geometry/geometry.h"
#include "guide/guiding_field.h"

namespace gradus::image {
class ImageStore;  // image/image_store.h
}  // namespace gradus::image

namespace gradus::shading {

struct MaterialData;    // defined in shading/material.h
class FaultyMaterials;  // shading/faulty_materials.h

// Geometry with materials and images. It is the base class of a snapshot that functions which run node programs take.
class ShadedScene : public geometry::Geometry {
 public:
  std::vector<std::shared_ptr<const MaterialData>> materials;  // the first is the default material
  std::shared_ptr<FaultyMaterials> faulty_materials;           // of all renders of the snapshot; null: none are noted
  std::shared_ptr<const image::ImageStore> images;
  std::shared_ptr<const guide::GuidingField> guiding;  // null: no directions are guided
  GradusCamera camera{};  // in internal space; its arrays belong to Snapshot::camera_keys
  bool has_camera = false;
  GradusWorld world{};
  uint32_t world_material = UINT32_MAX;
};

}  // namespace gradus::shading
