// Owning copy of the instances that the caller set.
#pragma once

#include <string>
#include <vector>

#include "base/hash.h"
#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::geometry {

struct InstanceArrays {
  size_t count = 0;
  std::vector<uint64_t> meshes;
  std::vector<uint64_t> ids;
  std::vector<Mat4> matrices, matrices_previous, matrices_next;  // the last two may be empty: at rest
  std::vector<uint32_t> visibility;
  std::vector<uint32_t> random_ids;
  std::vector<int32_t> pass_indices;
  std::vector<Vec4> colors;
  std::vector<Vec3> generated;
  std::vector<Vec2> uvs;
  std::vector<float> shadow_terminator_offsets;
  std::vector<uint32_t> material_first, material_count;  // empty: no materials
  std::vector<uint64_t> materials;
  std::vector<uint32_t> shutter_first, shutter_count;  // empty: nothing moves while the shutter is open
  std::vector<Mat4> shutter_matrices;
  std::vector<uint32_t> name_index;
  std::vector<std::string> names;

  // What a message calls instance i.
  std::string name(size_t i) const;
  // Without ids and the keys of meshes and materials, which are the caller's names for them.
  void hash(ContentHash* hash) const;
};

// Throws Error INVALID_ARGUMENT.
InstanceArrays copy_instances(const GradusInstances& desc);

}  // namespace gradus::geometry
