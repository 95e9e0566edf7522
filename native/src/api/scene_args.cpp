#include "api/scene_args.h"

#include "api/guard.h"
#include "api/structs.h"
#include "geometry/matrix_keys.h"
#include "geometry/mesh.h"

namespace gradus::api {
namespace {

void check_enum(uint32_t value, uint32_t count, const char* name) {
  if (value >= count)
    throw invalid_argument(std::string(name) + " is " + std::to_string(value) + ", expected less than " +
                           std::to_string(count));
}

// Checks an array of names, none of which may be NULL.
void check_names(const char* const* names, size_t count, const char* array) {
  check_array(names, count, array);
  for (size_t i = 0; i < count; ++i) {
    const std::string name = std::string(array) + "[" + std::to_string(i) + "]";
    if (!names[i]) throw invalid_argument(name + " is NULL");
    checked_name(names[i], name.c_str());
  }
}

// Checks that [first, first + count) lies in an array of `size` elements. Sums that overflow are handled.
void check_range(uint64_t first, uint64_t count, uint64_t size, const std::string& name) {
  if (first > size || count > size - first)
    throw invalid_argument(name + " reaches beyond its array of " + std::to_string(size));
}

void check_tile(const GradusImageTile& tile) {
  constexpr uint32_t kMaxSide = 1 << 16;
  check_enum(tile.source, 4, "tile.source");
  if (tile.source == GRADUS_IMAGE_FILE) return;  // An empty or missing path is damaged data, which gives a warning.
  if (tile.data_size > 0 && !tile.data) throw invalid_argument("tile.data is NULL");
  if (tile.source == GRADUS_IMAGE_ENCODED) return;
  if (tile.width > kMaxSide || tile.height > kMaxSide) throw invalid_argument("tile: more than 65536 pixels on a side");
  const size_t pixel_size = tile.source == GRADUS_IMAGE_FLOAT ? 4 * sizeof(float) : 4;
  if (tile.data_size != size_t(tile.width) * tile.height * pixel_size) {
    throw invalid_argument("tile.data_size is " + std::to_string(tile.data_size) + " for " +
                           std::to_string(tile.width) + " x " + std::to_string(tile.height) + " pixels of " +
                           std::to_string(pixel_size) + " bytes");
  }
  if (tile.source == GRADUS_IMAGE_FLOAT)
    check_array(static_cast<const float*>(tile.data), tile.data_size / sizeof(float), "tile.data");
}

}  // namespace

MeshArgs::MeshArgs(const GradusMesh* from) : mesh(read_struct(from, "mesh")) {
  mesh.name = checked_name(mesh.name, "mesh.name");
  checked_name(mesh.default_uv, "mesh.default_uv");
  if (mesh.key_count == 0 || mesh.key_count > geometry::kMaxShutterKeys)
    throw invalid_argument("mesh.key_count is " + std::to_string(mesh.key_count) + ", not 1 to " +
                           std::to_string(geometry::kMaxShutterKeys));
  if (mesh.key_count > 1) check_array(mesh.key_times, mesh.key_count, "mesh.key_times");
  check_array(mesh.positions, mesh.vertex_count, "mesh.positions", size_t{3} * mesh.key_count);
  check_array(mesh.corner_vertices, mesh.corner_count, "mesh.corner_vertices");
  check_array(mesh.triangle_corners, mesh.triangle_count, "mesh.triangle_corners", 3);
  check_array(mesh.triangle_faces, mesh.triangle_count, "mesh.triangle_faces", 1, Presence::Optional);
  check_array(mesh.face_materials, mesh.face_count, "mesh.face_materials", 1, Presence::Optional);
  check_enum(mesh.normal_domain, 3, "mesh.normal_domain");
  const bool optional =
      mesh.normal_domain != GRADUS_DOMAIN_CORNER;  // FACE: the mesh is flat; POINT: Gradus computes them
  check_array(mesh.normals, geometry::domain_size(mesh, mesh.normal_domain), "mesh.normals", 3,
              optional ? Presence::Optional : Presence::Required);
  check_array(mesh.generated_points, mesh.vertex_count, "mesh.generated_points", 3, Presence::Optional);
  check_array(mesh.edge_vertices, mesh.edge_count, "mesh.edge_vertices", 2);
  attributes = read_struct_array(mesh.attributes, mesh.attribute_count, "mesh.attributes");
  for (GradusAttribute& attribute : attributes) {
    attribute.name = checked_name(attribute.name, "attribute.name");
    check_enum(attribute.domain, 3, "attribute.domain");
    if (attribute.channels < 1 || attribute.channels > 4) throw invalid_argument("attribute.channels is not 1 to 4");
    check_array(attribute.data, geometry::domain_size(mesh, attribute.domain), "attribute.data", attribute.channels);
  }
  mesh.attributes = attributes.data();
}

ImageArgs::ImageArgs(const GradusImage* from) : image(read_struct(from, "image")) {
  image.name = checked_name(image.name, "image.name");
  image.color_space = checked_name(image.color_space, "image.color_space");
  check_enum(image.alpha_mode, GRADUS_ALPHA_ALWAYS_STRAIGHT + 1, "image.alpha_mode");
  tiles = read_struct_array(image.tiles, image.tile_count, "image.tiles");
  for (GradusImageTile& tile : tiles) {
    if (!tile.path) tile.path = "";  // A path need not be UTF-8.
    check_tile(tile);
  }
  image.tiles = tiles.data();
}

GradusMaterial read_material(const GradusMaterial* from) {
  GradusMaterial m = read_struct(from, "material");
  m.name = checked_name(m.name, "material.name");
  check_array(m.nodes, m.node_count, "material.nodes");
  check_array(m.inputs, m.input_count, "material.inputs");
  check_array(m.floats, m.float_count, "material.floats");
  check_names(m.names, m.name_count, "material.names");
  if (m.surface >= 0 && uint32_t(m.surface) >= m.node_count) throw invalid_argument("material.surface is not a node");
  for (uint32_t i = 0; i < m.node_count; ++i) {
    const GradusNode& node = m.nodes[i];
    const std::string name = std::string(m.name) + ": node " + std::to_string(i);
    check_range(node.first_input, node.input_count, m.input_count, name + ": first_input, input_count");
    check_range(node.first_float, node.float_count, m.float_count, name + ": first_float, float_count");
    for (uint32_t k = 0; k < node.input_count; ++k) {
      const int32_t source = m.inputs[node.first_input + k].node;
      if (source < -1 || source >= int64_t(i))
        throw invalid_argument(name + ": input " + std::to_string(k) + " is not an earlier node");
    }
  }
  return m;
}

GradusInstances read_instances(const GradusInstances* from) {
  const GradusInstances in = read_struct(from, "instances");
  const auto optional = [&](const auto* data, const char* name, size_t width = 1) {
    check_array(data, in.count, name, width, Presence::Optional);
  };
  check_array(in.meshes, in.count, "instances.meshes");
  check_array(in.matrices, in.count, "instances.matrices", 16);
  optional(in.ids, "instances.ids");
  optional(in.matrices_previous, "instances.matrices_previous", 16);
  optional(in.matrices_next, "instances.matrices_next", 16);
  optional(in.visibility, "instances.visibility");
  optional(in.random_ids, "instances.random_ids");
  optional(in.pass_indices, "instances.pass_indices");
  optional(in.colors, "instances.colors", 4);
  optional(in.generated, "instances.generated", 3);
  optional(in.uvs, "instances.uvs", 2);
  optional(in.shadow_terminator_offsets, "instances.shadow_terminator_offsets");
  optional(in.receiver_sets, "instances.receiver_sets");
  optional(in.receiver_masks, "instances.receiver_masks");
  optional(in.blocker_sets, "instances.blocker_sets");
  optional(in.blocker_masks, "instances.blocker_masks");
  optional(in.shadow_terminator_shading_offsets, "instances.shadow_terminator_shading_offsets");
  optional(in.material_first, "instances.material_first");
  optional(in.name_index, "instances.name_index");
  optional(in.asset_name_index, "instances.asset_name_index");
  optional(in.light_groups, "instances.light_groups");
  check_array(in.materials, in.materials_size, "instances.materials");
  check_names(in.names, in.name_count, "instances.names");
  check_names(in.attribute_names, in.attribute_count, "instances.attribute_names");
  if (in.attribute_count > 0)
    check_array(in.attributes, in.count, "instances.attributes", size_t{4} * in.attribute_count);
  if (in.material_first) check_array(in.material_count, in.count, "instances.material_count");
  for (size_t i = 0; i < in.count; ++i) {
    if (in.material_first)
      check_range(in.material_first[i], in.material_count[i], in.materials_size,
                  "instances.material_first, material_count");
    if (in.name_index) check_range(in.name_index[i], 1, in.name_count, "instances.name_index");
    if (in.asset_name_index) check_range(in.asset_name_index[i], 1, in.name_count, "instances.asset_name_index");
  }
  return in;
}

std::vector<GradusLight> read_lights(const GradusLight* from, size_t count) {
  std::vector<GradusLight> lights = read_struct_array(from, count, "lights");
  for (GradusLight& light : lights) {
    light.name = checked_name(light.name, "light.name");
    check_enum(light.type, 5, "light.type");
    check_array(light.attributes, light.attribute_count, "light.attributes", 4);
  }
  return lights;
}

GradusCamera read_camera(const GradusCamera* from) {
  const GradusCamera camera = read_struct(from, "camera");
  check_enum(camera.type, 3, "camera.type");
  check_enum(camera.panorama, 7, "camera.panorama");
  return camera;
}

GradusWorld read_world(const GradusWorld* from) {
  const GradusWorld world = read_struct(from, "world");
  check_enum(world.importance, 3, "world.importance");
  check_enum(world.mist_falloff, 3, "world.mist_falloff");
  return world;
}

std::vector<GradusChannel> read_channels(const GradusChannel* from, size_t count) {
  std::vector<GradusChannel> channels = read_struct_array(from, count, "channels");
  for (GradusChannel& channel : channels) {
    channel.name = checked_name(channel.name, "channel.name");
    check_enum(channel.kind, GRADUS_CHANNEL_CRYPTOMATTE_ASSET + 1, "channel.kind");
  }
  return channels;
}

}  // namespace gradus::api
