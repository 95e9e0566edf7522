// visit() for every struct of the scene calls; see archive.h. Changing one changes the format: raise kSceneFormat.
#pragma once

#include "gradus/gradus.h"
#include "scene/mesh.h"

namespace gradus::api {

template <class T>
void set_size(T& s) {
  s.struct_size = sizeof(T);
}

template <class Archive>
void visit(Archive& a, GradusMesh& m) {
  set_size(m);
  a.text(m.name);
  a.value(m.key_count);
  a.value(m.vertex_count);
  a.value(m.corner_count);
  a.value(m.triangle_count);
  a.value(m.face_count);
  a.value(m.normal_domain);
  a.value(m.attribute_count);
  a.values(m.generated_location);
  a.values(m.generated_size);
  a.array(m.key_times, m.key_count);
  a.array(m.positions, uint64_t{3} * m.vertex_count * m.key_count);
  a.array(m.corner_vertices, m.corner_count);
  a.array(m.triangle_corners, uint64_t{3} * m.triangle_count);
  a.array(m.triangle_faces, m.triangle_count);
  a.array(m.face_materials, m.face_count);
  a.array(m.normals, 3 * domain_size(m, m.normal_domain));
  a.array(m.generated_points, uint64_t{3} * m.vertex_count);
  a.value(m.shutter_key_count);
  a.array(m.shutter_positions, uint64_t{3} * m.vertex_count * m.shutter_key_count);
  uint32_t has_default_uv = m.default_uv != nullptr;
  a.value(has_default_uv);
  if (has_default_uv) a.text(m.default_uv);
  // Attributes need the mesh's counts, so they are not structs on their own.
  a.structs(m.attributes, m.attribute_count);
  for (uint32_t i = 0; i < m.attribute_count; ++i) {
    auto& attribute = const_cast<GradusAttribute&>(m.attributes[i]);
    a.array(attribute.data, uint64_t{domain_size(m, attribute.domain)} * attribute.channels);
  }
}

template <class Archive>
void visit(Archive& a, GradusAttribute& attribute) {
  set_size(attribute);
  a.text(attribute.name);
  a.value(attribute.domain);
  a.value(attribute.channels);
  a.value(attribute.is_uv);
}

template <class Archive>
void visit(Archive& a, GradusImageTile& tile) {
  set_size(tile);
  a.value(tile.number);
  a.value(tile.source);
  a.value(tile.width);
  a.value(tile.height);
  a.text(tile.path);
  a.value(tile.data_size);
  const char* bytes = static_cast<const char*>(tile.data);
  a.array(bytes, tile.data_size);
  tile.data = bytes;
}

template <class Archive>
void visit(Archive& a, GradusImage& image) {
  set_size(image);
  a.text(image.name);
  a.text(image.color_space);
  a.value(image.alpha_mode);
  a.value(image.is_float);
  a.value(image.tile_count);
  a.structs(image.tiles, image.tile_count);
}

template <class Archive>
void visit(Archive& a, GradusNode& node) {
  a.value(node.op);
  a.value(node.mode);
  a.value(node.first_input);
  a.value(node.input_count);
  a.value(node.first_float);
  a.value(node.float_count);
  a.value(node.resource);
}

template <class Archive>
void visit(Archive& a, GradusInput& input) {
  a.value(input.node);
  a.value(input.output);
  a.values(input.value);
}

template <class Archive>
void visit(Archive& a, GradusMaterial& m) {
  set_size(m);
  a.text(m.name);
  a.value(m.node_count);
  a.value(m.input_count);
  a.value(m.float_count);
  a.value(m.name_count);
  a.value(m.surface);
  a.value(m.pass_index);
  a.value(m.sample_as_light);
  a.value(m.transparent_shadow);
  a.value(m.uses_fallback);
  a.structs(m.nodes, m.node_count);
  a.structs(m.inputs, m.input_count);
  a.array(m.floats, m.float_count);
  a.texts(m.names, m.name_count);
}

template <class Archive>
void visit(Archive& a, GradusInstances& in) {
  set_size(in);
  a.value(in.count);
  a.value(in.materials_size);
  a.value(in.name_count);
  a.array(in.meshes, in.count);
  a.array(in.ids, in.count);
  a.array(in.matrices, uint64_t{16} * in.count);
  a.array(in.matrices_previous, uint64_t{16} * in.count);
  a.array(in.matrices_next, uint64_t{16} * in.count);
  a.array(in.visibility, in.count);
  a.array(in.random_ids, in.count);
  a.array(in.pass_indices, in.count);
  a.array(in.colors, uint64_t{4} * in.count);
  a.array(in.generated, uint64_t{3} * in.count);
  a.array(in.uvs, uint64_t{2} * in.count);
  a.array(in.shadow_terminator_offsets, in.count);
  a.array(in.material_first, in.count);
  a.array(in.material_count, in.count);
  a.array(in.materials, in.materials_size);
  a.array(in.name_index, in.count);
  a.value(in.shutter_size);
  a.array(in.shutter_first, in.count);
  a.array(in.shutter_count, in.count);
  a.array(in.shutter_matrices, uint64_t{16} * in.shutter_size);
  a.texts(in.names, in.name_count);
}

template <class Archive>
void visit(Archive& a, GradusLight& light) {
  set_size(light);
  a.text(light.name);
  a.value(light.type);
  a.value(light.flags);
  a.value(light.visibility);
  a.values(light.matrix);
  a.values(light.strength);
  a.value(light.radius);
  a.value(light.angle);
  a.values(light.size);
  a.value(light.spread);
  a.value(light.cone);
  a.value(light.blend);
  a.value(light.sun_radiance_per_irradiance);
  a.value(light.material);
  a.value(light.max_bounces);
  a.value(light.pass_index);
}

template <class Archive>
void visit(Archive& a, GradusCamera& camera) {
  set_size(camera);
  a.value(camera.type);
  a.values(camera.matrix);
  a.values(camera.matrix_previous);
  a.values(camera.matrix_next);
  a.values(camera.window);
  a.values(camera.window_previous);
  a.values(camera.window_next);
  a.value(camera.clip_start);
  a.value(camera.clip_end);
  a.value(camera.aperture_radius);
  a.value(camera.focus_distance);
  a.value(camera.blades);
  a.value(camera.blade_rotation);
  a.value(camera.aperture_ratio);
  a.value(camera.panorama);
  a.value(camera.fisheye_fov);
  a.values(camera.fisheye_polynomial);
  a.value(camera.eye_offset);
  a.value(camera.convergence_distance);
  a.value(camera.pole_merge_from);
  a.value(camera.pole_merge_to);
  a.value(camera.shutter_key_count);
  a.value(camera.shutter_open);
  a.value(camera.shutter_close);
  a.value(camera.shutter_curve_count);
  a.array(camera.shutter_curve, camera.shutter_curve_count);
  a.array(camera.shutter_matrices, uint64_t{16} * camera.shutter_key_count);
  a.array(camera.shutter_windows, uint64_t{4} * camera.shutter_key_count);
}

template <class Archive>
void visit(Archive& a, GradusWorld& world) {
  set_size(world);
  a.value(world.visibility);
  a.value(world.material);
  a.value(world.importance);
  a.value(world.map_size);
  a.value(world.mist_start);
  a.value(world.mist_depth);
  a.value(world.mist_falloff);
  a.value(world.ao_distance);
}

// The list of lights, which one call sets.
struct LightList {
  const GradusLight* lights = nullptr;
  size_t count = 0;
};

template <class Archive>
void visit(Archive& a, LightList& list) {
  a.value(list.count);
  a.structs(list.lights, list.count);
}

}  // namespace gradus::api
