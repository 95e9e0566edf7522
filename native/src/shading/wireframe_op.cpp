// The Wireframe node.
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Returns the distance between two directions.
float angle(const Vec3& a, const Vec3& b) { return glm::distance(glm::normalize(a), glm::normalize(b)); }

// The camera's view of a point.
struct View {
  Vec3 direction;             // unit vector towards the camera
  float pixel_length = 0.0f;  // mean length of a pixel's sides at the point, on a plane across the view
};

// Views depend on the point alone, also in reflections, so that paths which are shifted see the same lines.
View view_of(const ResourceArgs& args, const ShadeContext& c) {
  const GradusCamera& camera = c.scene->camera;
  const float* m = camera.matrix;
  const Vec3 right(m[0], m[1], m[2]), up(m[4], m[5], m[6]), back(m[8], m[9], m[10]);
  const float width = (camera.window[1] - camera.window[0]) * args.floats[0];
  const float height = (camera.window[3] - camera.window[2]) * args.floats[1];
  if (camera.type == GRADUS_CAMERA_ORTHOGRAPHIC) return {back, 0.5f * (width + height)};
  const Vec3 p = c.position - Vec3(m[12], m[13], m[14]);
  const float distance = glm::length(p), depth = -glm::dot(p, back);
  if (camera.type == GRADUS_CAMERA_PANORAMA) return {-safe_normalize(p), distance * 0.5f * (width + height)};
  if (!(depth > 0.0f)) return {-safe_normalize(p), 0.0f};
  const Vec3 ray(glm::dot(p, right) / depth, glm::dot(p, up) / depth, 1.0f);
  const float angles = angle(ray + Vec3(width, 0, 0), ray) + angle(ray + Vec3(0, height, 0), ray);
  return {-safe_normalize(p), distance * 0.5f * angles};
}

// Returns the size of a pixel as Cycles has it: the mean length of two axes of the surface's plane, which are as long
// as a pixel, on the plane across the view.
float pixel_size(const ResourceArgs& args, const ShadeContext& c) {
  if (!c.scene->has_camera) return 0.0f;
  const View view = view_of(args, c);
  const Vec3& n = c.geometric_normal;
  const Vec3 across =
      n.x != n.y || n.x != n.z ? Vec3(n.z - n.y, n.x - n.z, n.y - n.x) : Vec3(n.z - n.y, n.x + n.z, -n.y - n.x);
  const Vec3 x = glm::normalize(across), y = glm::cross(n, x);
  const auto seen = [&](const Vec3& axis) {
    return glm::length(axis - glm::dot(axis, view.direction) * view.direction);
  };
  return 0.5f * (seen(x) + seen(y)) * view.pixel_length;
}

// Returns whether the point is closer to an edge of its triangle than half the width of a line.
bool is_on_line(const ShadeContext& c, float width) {
  const std::array<Vec3, 3> p = c.scene->corners(c.hit.instance, c.hit.primitive, c.hit.time);
  for (size_t i = 0; i < 3; ++i) {
    const Vec3 edge = p[(i + 1) % 3] - p[i];
    if (glm::length(glm::cross(edge, c.position - p[i])) < glm::length(edge) * 0.5f * std::fabs(width)) return true;
  }
  return false;
}

}  // namespace

void wireframe_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  bool on_line = false;
  if (c.scene && c.instance) on_line = is_on_line(c, args.f(0) * (args.mode == 1 ? pixel_size(args, c) : 1.0f));
  out[0] = splat(on_line ? 1.0f : 0.0f);
}

}  // namespace gradus::shading
