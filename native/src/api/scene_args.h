// Arguments of gradus_scene_set_*. Structs of older callers are completed, pointers, counts, enums and the encoding of
// names are checked, and texts that may be NULL become "". The scene itself checks the contents of the arrays.
#pragma once

#include <vector>

#include "gradus/gradus.h"

namespace gradus::api {

struct MeshArgs {
  explicit MeshArgs(const GradusMesh* from);
  GradusMesh mesh;
  std::vector<GradusAttribute> attributes;
};

struct ImageArgs {
  explicit ImageArgs(const GradusImage* from);
  GradusImage image;
  std::vector<GradusImageTile> tiles;
};

GradusMaterial read_material(const GradusMaterial* from);
GradusInstances read_instances(const GradusInstances* from);
std::vector<GradusLight> read_lights(const GradusLight* from, size_t count);
GradusCamera read_camera(const GradusCamera* from);
GradusWorld read_world(const GradusWorld* from);
std::vector<GradusChannel> read_channels(const GradusChannel* from, size_t count);

}  // namespace gradus::api
