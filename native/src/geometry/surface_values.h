// What the shape of an instance has at a hit: attributes, texture coordinates, normals and tangents, in the shape's own
// space. Callers need not know the kind of its primitives.
#pragma once

#include "geometry/geometry.h"
#include "geometry/mesh.h"
#include "geometry/tangent_field.h"

namespace gradus::geometry {

// Returns an attribute of the shape, interpolated at the hit. Missing channels are 0, a missing fourth channel is 1.
inline Vec4 attribute_at(const InstanceData& instance, const MeshAttribute& attribute, const Hit& hit) {
  return interpolate(corner_values(*instance.mesh, attribute, hit.primitive), hit.uv);
}

// Returns the generated texture coordinates: 0 to 1 over the shape's texture space.
inline Vec3 generated_at(const InstanceData& instance, const Hit& hit) {
  return generated_at(*instance.mesh, hit.primitive, hit.uv);
}

// Returns what Blender's Parametric output shows: the weights of the first two corners of a triangle.
inline Vec3 parametric_at(const Hit& hit) { return Vec3(1.0f - hit.uv.x - hit.uv.y, hit.uv.x, 0.0f); }

// Returns the pointiness, interpolated at the hit; 0 if the shape has none.
inline float pointiness_at(const InstanceData& instance, const Hit& hit) {
  const MeshData& mesh = *instance.mesh;
  if (mesh.pointiness.empty()) return 0.0f;
  const uint32_t* v = mesh.triangle_vertices.data() + size_t(hit.primitive) * 3;
  return interpolate(std::array<float, 3>{mesh.pointiness[v[0]], mesh.pointiness[v[1]], mesh.pointiness[v[2]]}, hit.uv);
}

// Finds the number of the connected part that is hit. Returns false if the shape knows none.
inline bool island_at(const InstanceData& instance, const Hit& hit, uint32_t* island) {
  const MeshData& mesh = *instance.mesh;
  if (mesh.islands.empty()) return false;
  *island = mesh.islands[mesh.triangle_vertices[size_t(hit.primitive) * 3]];
  return true;
}

// Finds the interpolated shading normal at the shutter time of the hit, not normalised. Returns false if the shape is
// shaded flat.
inline bool smooth_normal_at(const InstanceData& instance, const Hit& hit, Vec3* normal) {
  std::array<Vec3, 3> normals;
  if (!triangle_normals_in_shutter(*instance.mesh, hit.primitive, hit.time, &normals)) return false;
  *normal = interpolate(normals, hit.uv);
  return true;
}

// Finds the normals of smooth_normal_at() in the rendered frame (`frame_normal`) and at the shutter time of the hit
// (`hit_normal`). Returns false if they are equal: the shape does not deform, or is shaded flat.
inline bool turned_normals_at(const InstanceData& instance, const Hit& hit, Vec3* frame_normal, Vec3* hit_normal) {
  std::array<Vec3, 3> normals;
  if (instance.mesh->shutter_keys == 0 || !triangle_normals(*instance.mesh, hit.primitive, &normals)) return false;
  *frame_normal = interpolate(normals, hit.uv);
  return smooth_normal_at(instance, hit, hit_normal);
}

// Returns a tangent of the rendered frame, with its handedness in w.
inline Vec4 tangent_at(const TangentField& field, const Hit& hit) {
  return interpolate(field.corners(hit.primitive), hit.uv);
}

}  // namespace gradus::geometry
