// An owning copy of the instances that the caller passed to Scene::set_instances().
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::geometry {

// One element per instance in each array, except where a comment says otherwise. The meaning of the arrays is that of
// the GradusInstances members of the same name.
struct InstanceArrays {
  size_t count = 0;
  std::vector<uint64_t> meshes;
  std::vector<uint64_t> ids;
  std::vector<Mat4> matrices, matrices_previous, matrices_next;  // the last two are empty: unchanged
  std::vector<uint32_t> visibility;
  std::vector<uint32_t> random_ids;
  std::vector<int32_t> pass_indices;
  std::vector<Vec4> colors;
  std::vector<Vec3> generated;
  std::vector<Vec2> uvs;
  std::vector<float> shadow_terminator_offsets, shadow_terminator_shading_offsets;
  std::vector<uint32_t> material_first, material_count;  // empty: no materials
  std::vector<uint64_t> materials;                       // keys of the slots of all instances
  std::vector<uint32_t> shutter_first, shutter_count;    // empty: nothing moves while the shutter is open
  std::vector<Mat4> shutter_matrices;                    // keys of all instances
  std::vector<uint32_t> light_groups;
  std::vector<uint32_t> receiver_sets, blocker_sets;
  std::vector<uint64_t> receiver_masks, blocker_masks;
  std::vector<uint32_t> name_index, asset_name_index;  // index in `names` of each instance
  std::vector<std::string> names;                      // names of objects
  std::vector<std::string> attribute_names;
  std::vector<Vec4> attributes;  // a value of each instance for the first name, then for the next

  // Returns the name of instance i for messages, or its number if it has none.
  std::string name(size_t i) const;
  // Return the index in `names` of the name of instance i and of its topmost parent, which is its own if no other is
  // known; names.size() if it has none.
  size_t object_name(size_t i) const {
    return i < name_index.size() ? std::min<size_t>(name_index[i], names.size()) : names.size();
  }
  size_t asset_name(size_t i) const {
    return i < asset_name_index.size() ? std::min<size_t>(asset_name_index[i], names.size()) : object_name(i);
  }
  // Adds the contents to a hash. Ids, and the keys of meshes and materials, are left out: they are names that the
  // caller chose, and may differ from one session to the next. Names and light groups are left out, too.
  void hash(ContentHash* hash) const;
  // Adds what only channels of the film show to a hash: names, if with_names, and light groups.
  void hash_for_channels(bool with_names, ContentHash* hash) const;
};

// Checks and copies the caller's arrays. Throws Error INVALID_ARGUMENT if an array is missing or an index is out of
// range.
InstanceArrays copy_instances(const GradusInstances& desc);

}  // namespace gradus::geometry
