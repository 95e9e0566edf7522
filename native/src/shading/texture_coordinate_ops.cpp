// The Texture Coordinate, UV Map, Camera Data and Vector Transform nodes.
#include <cstring>

#include "camera/panorama.h"
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

Mat4 matrix(const float* values) {
  Mat4 m;
  std::memcpy(&m[0][0], values, sizeof(float) * 16);
  return m;
}

// Transform directions to and from camera space, which looks along +z. The camera's matrix has no scale.
Vec3 direction_to_camera(const Mat4& camera, const Vec3& v) {
  return Vec3(glm::dot(Vec3(camera[0]), v), glm::dot(Vec3(camera[1]), v), -glm::dot(Vec3(camera[2]), v));
}
Vec3 direction_from_camera(const Mat4& camera, const Vec3& v) {
  return Vec3(camera[0]) * v.x + Vec3(camera[1]) * v.y - Vec3(camera[2]) * v.z;
}

Vec3 to_object(const ResourceArgs& args, const ShadeContext& c) {
  if (args.float_count >= 16) return Vec3(matrix(args.floats) * Vec4(world_position(c), 1.0f));
  return local_position(c);
}

// Transforms a point of internal space, or a direction on the background, to camera space.
Vec3 to_camera(const ShadeContext& c, const Vec3& p) {
  if (!c.scene || !c.scene->has_camera) return p;
  const Mat4 camera = matrix(c.scene->camera.matrix);
  return direction_to_camera(camera, c.is_background ? p : p - Vec3(camera[3]));
}

// Returns the point in camera space. For lights without an object, Cycles takes the position for a direction, as on the
// background.
Vec3 camera_coordinates(const ShadeContext& c) {
  if (!c.light || object_of(c) || !c.scene || !c.scene->has_camera) return to_camera(c, c.position);
  return direction_to_camera(matrix(c.scene->camera.matrix), world_position(c));
}

// Returns the position in the picture, which spans 0…1 on both axes.
Vec3 window(const ShadeContext& c) {
  if (!c.scene || !c.scene->has_camera) return Vec3(0.0f);
  const GradusCamera& camera = c.scene->camera;
  const bool is_flat = camera.type == GRADUS_CAMERA_ORTHOGRAPHIC;
  const Vec3 p = is_flat ? to_camera(c, c.position) : camera_coordinates(c);
  Vec2 plane(p);
  if (camera.type == GRADUS_CAMERA_PERSPECTIVE) plane = p.z != 0.0f ? plane / p.z : Vec2(0.0f);
  if (camera.type == GRADUS_CAMERA_PANORAMA &&
      (p == Vec3(0.0f) || !camera::panorama_point(camera, safe_normalize(Vec3(p.x, p.y, -p.z)), &plane)))
    return Vec3(0.0f);
  const float* w = camera.window;
  return Vec3(safe_divide(plane.x - w[0], w[1] - w[0]), safe_divide(plane.y - w[2], w[3] - w[2]), 0.0f);
}

Vec3 uv_map(const ResourceArgs& args, const ShadeContext& c) {
  if (!c.instance && !c.light) return Vec3(c.uv, 0.0f);
  return Vec3(Vec2(attribute_value(c, args.name, true, nullptr)), 0.0f);
}

enum Space : uint32_t { kWorld = 0, kObject = 1, kCamera = 2 };

Vec3 to_world(uint32_t space, uint32_t kind, const Vec3& v, const ShadeContext& c) {
  const float w = kind == GRADUS_TRANSFORM_POINT ? 1.0f : 0.0f;
  const Vec3 origin = c.scene ? c.scene->origin : Vec3(0.0f);
  if (space == kObject && object_of(c)) {
    geometry::Placement storage;
    const geometry::Placement& placement = placement_of(c, &storage);
    if (kind == GRADUS_TRANSFORM_NORMAL) return placement.normal_to_world * v;
    return Vec3(placement.to_world * Vec4(v, w)) + origin * w;
  }
  if (space == kCamera && c.scene && c.scene->has_camera) {
    const Mat4 camera = matrix(c.scene->camera.matrix);
    return direction_from_camera(camera, v) + (Vec3(camera[3]) + origin) * w;
  }
  return v;
}

Vec3 from_world(uint32_t space, uint32_t kind, const Vec3& v, const ShadeContext& c) {
  const float w = kind == GRADUS_TRANSFORM_POINT ? 1.0f : 0.0f;
  const Vec3 origin = c.scene ? c.scene->origin : Vec3(0.0f);
  if (space == kObject && kind == GRADUS_TRANSFORM_NORMAL && c.light && c.light->has_uv_map)
    return normal_to_local(c, v);
  if (space == kObject && object_of(c)) {
    geometry::Placement storage;
    const geometry::Placement& placement = placement_of(c, &storage);
    if (kind == GRADUS_TRANSFORM_NORMAL) return glm::transpose(Mat3(placement.to_world)) * v;
    return Vec3(placement.to_local * Vec4(v - origin * w, w));
  }
  if (space == kCamera && c.scene && c.scene->has_camera) {
    const Mat4 camera = matrix(c.scene->camera.matrix);
    return direction_to_camera(camera, v - (Vec3(camera[3]) + origin) * w);
  }
  return v;
}

Vec3 coordinates(const ResourceArgs& args, const ShadeContext& c) {
  const geometry::ObjectData* object = object_of(c);
  switch (args.mode) {
    case GRADUS_TEX_COORD_NORMAL:
      return normal_to_local(c, c.normal);
    case GRADUS_TEX_COORD_UV:
      return uv_map(args, c);
    case GRADUS_TEX_COORD_OBJECT:
      return to_object(args, c);
    case GRADUS_TEX_COORD_CAMERA:
      return camera_coordinates(c);
    case GRADUS_TEX_COORD_WINDOW:
      return window(c);
    case GRADUS_TEX_COORD_REFLECTION:
      return object ? c.normal * (2.0f * glm::dot(c.wo, c.normal)) - c.wo : c.wo;
    case GRADUS_TEX_COORD_INSTANCER_GENERATED:
      return object ? object->generated : Vec3(0.0f);
    case GRADUS_TEX_COORD_INSTANCER_UV:
      return object ? Vec3(object->uv, 0.0f) : Vec3(0.0f);
    default:
      return generated(c);
  }
}

}  // namespace

void tex_coord_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) { out[0] = value(coordinates(args, c)); }

void camera_data_op(const ResourceArgs&, const ShadeContext& c, Vec4* out) {
  const Vec3 p = to_camera(c, c.position);
  out[0] = value(safe_normalize(p));
  out[1] = splat(p.z);
  out[2] = splat(glm::length(p));
}

void vector_transform_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const uint32_t kind = args.mode & 3;
  const Vec3 moved = from_world(args.mode >> 4 & 3, kind, to_world(args.mode >> 2 & 3, kind, args.v(0), c), c);
  out[0] = value(kind == GRADUS_TRANSFORM_NORMAL ? safe_normalize(moved) : moved);
}

}  // namespace gradus::shading
