#include "geometry/instance_arrays.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/hash.h"
#include "geometry/matrix_keys.h"

namespace gradus::geometry {

namespace {

constexpr size_t kMaxInstances = size_t(1) << 30;

void require(bool good, const char* text) {
  if (!good) throw invalid_argument(std::string("instances: ") + text);
}

// Copies `count` elements. Several consecutive values of type From may form one element of type To.
template <class To, class From>
std::vector<To> copy(const From* data, size_t count) {
  std::vector<To> out;
  if (!data || count == 0) return out;
  out.resize(count);
  std::memcpy(static_cast<void*>(out.data()), data, count * sizeof(To));
  return out;
}

// Throws Error INVALID_ARGUMENT if an array is missing or a range exceeds its array.
void check(const GradusInstances& d) {
  require(d.count < kMaxInstances, "too many");
  require(d.count == 0 || d.meshes, "meshes missing");
  require(d.count == 0 || d.matrices, "matrices missing");
  require(!d.material_first || d.material_count, "material_count missing");
  require(d.materials_size == 0 || d.materials, "materials missing");
  require(!d.shutter_first || d.shutter_count, "shutter_count missing");
  require(d.shutter_size == 0 || d.shutter_matrices, "shutter_matrices missing");
  for (size_t i = 0; d.shutter_first && i < d.count; ++i) {
    check_shutter_key_count("instance " + std::to_string(i), d.shutter_count[i]);
    require(uint64_t(d.shutter_first[i]) + d.shutter_count[i] <= d.shutter_size, "shutter_first is out of range");
  }
  for (const uint32_t* sets : {d.receiver_sets, d.blocker_sets})
    require(!sets || std::all_of(sets, sets + d.count, [](uint32_t set) { return set < 64; }), "set is above 63");
  require(d.attribute_count == 0 || d.attribute_names, "attribute_names missing");
  require(d.attribute_count == 0 || d.count == 0 || d.attributes, "attributes missing");
  require(!d.name_index || d.name_count == 0 || d.names, "names missing");
  for (size_t i = 0; d.material_first && i < d.count; ++i)
    require(uint64_t(d.material_first[i]) + d.material_count[i] <= d.materials_size, "material_first is out of range");
}

}  // namespace

InstanceArrays copy_instances(const GradusInstances& d) {
  check(d);
  InstanceArrays a;
  a.count = d.count;
  a.meshes = copy<uint64_t>(d.meshes, d.count);
  a.ids = copy<uint64_t>(d.ids, d.count);
  a.matrices = copy<Mat4>(d.matrices, d.count);
  a.matrices_previous = copy<Mat4>(d.matrices_previous, d.count);
  a.matrices_next = copy<Mat4>(d.matrices_next, d.count);
  a.visibility = copy<uint32_t>(d.visibility, d.count);
  a.random_ids = copy<uint32_t>(d.random_ids, d.count);
  a.pass_indices = copy<int32_t>(d.pass_indices, d.count);
  a.colors = copy<Vec4>(d.colors, d.count);
  a.generated = copy<Vec3>(d.generated, d.count);
  a.uvs = copy<Vec2>(d.uvs, d.count);
  a.shadow_terminator_offsets = copy<float>(d.shadow_terminator_offsets, d.count);
  a.shadow_terminator_shading_offsets = copy<float>(d.shadow_terminator_shading_offsets, d.count);
  a.material_first = copy<uint32_t>(d.material_first, d.count);
  if (d.material_first) a.material_count = copy<uint32_t>(d.material_count, d.count);
  a.materials = copy<uint64_t>(d.materials, d.materials_size);
  a.shutter_first = copy<uint32_t>(d.shutter_first, d.count);
  if (d.shutter_first) a.shutter_count = copy<uint32_t>(d.shutter_count, d.count);
  a.shutter_matrices = copy<Mat4>(d.shutter_matrices, d.shutter_size);
  a.light_groups = copy<uint32_t>(d.light_groups, d.count);
  a.receiver_sets = copy<uint32_t>(d.receiver_sets, d.count);
  a.receiver_masks = copy<uint64_t>(d.receiver_masks, d.count);
  a.blocker_sets = copy<uint32_t>(d.blocker_sets, d.count);
  a.blocker_masks = copy<uint64_t>(d.blocker_masks, d.count);
  a.name_index = copy<uint32_t>(d.name_index, d.count);
  a.asset_name_index = copy<uint32_t>(d.asset_name_index, d.count);
  for (size_t i = 0; d.names && i < d.name_count; ++i) a.names.emplace_back(d.names[i] ? d.names[i] : "");
  for (uint32_t i = 0; i < d.attribute_count; ++i)
    a.attribute_names.emplace_back(d.attribute_names[i] ? d.attribute_names[i] : "");
  a.attributes = copy<Vec4>(d.attributes, d.count * d.attribute_count);
  return a;
}

std::string InstanceArrays::name(size_t i) const {
  if (i < name_index.size() && name_index[i] < names.size()) return names[name_index[i]];
  return std::string("number ").append(std::to_string(i));
}

void InstanceArrays::hash_for_channels(bool with_names, ContentHash* hash) const {
  hash->array(light_groups);
  if (!with_names) return;
  hash->array(name_index);
  hash->array(asset_name_index);
  for (const std::string& name : names) hash->value(name);
}

void InstanceArrays::hash(ContentHash* hash) const {
  hash->array(matrices);
  hash->array(matrices_previous);
  hash->array(matrices_next);
  hash->array(visibility);
  hash->array(random_ids);
  hash->array(pass_indices);
  hash->array(colors);
  hash->array(generated);
  hash->array(uvs);
  hash->array(shadow_terminator_offsets);
  hash->array(shadow_terminator_shading_offsets);
  for (const auto* sets : {&receiver_sets, &blocker_sets}) hash->array(*sets);
  for (const auto* masks : {&receiver_masks, &blocker_masks}) hash->array(*masks);
  hash->array(material_first);
  hash->array(material_count);
  hash->array(shutter_first);
  hash->array(shutter_count);
  hash->array(shutter_matrices);
  for (const std::string& name : attribute_names) hash->value(name);
  hash->array(attributes);
}

}  // namespace gradus::geometry
