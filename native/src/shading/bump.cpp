// The Bump node, and the bump of a material's displacement.
#include "bsdf/shading_normal.h"
#include "geometry/surface_values.h"
#include "shading/displacement.h"
#include "shading/interpreter.h"
#include "shading/material.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// The angle of about one pixel of a 1080p picture, which gives the step of the finite differences. The step depends on
// the point alone, because a path that is shifted onto a point must get the same normal as any other path there.
constexpr float kPixelAngle = 7e-4f;
// Minimum step as a fraction of the largest coordinate; a shorter step would be lost in rounding errors.
constexpr float kSmallestStep = 2e-5f;

// Returns the step of the finite differences, in scene units.
float step_length(const ShadeContext& c, float filter_width) {
  const float pixels = camera_distance(c) * kPixelAngle * filter_width;
  return std::max(std::max(pixels, kSmallestStep * max_component(glm::abs(c.position))), 1e-7f);
}

// The three heights of a bump, and the steps between their points.
struct HeightField {
  float center = 0.0f, x = 0.0f, y = 0.0f;
  Vec3 dx, dy;  // unit vectors in the plane of the geometric normal
  float step = 1.0f;
};

// Evaluates a height around a point. `height` returns that of a context.
template <class Height>
HeightField sample_heights(const ShadeContext& c, float filter_width, const Height& height) {
  HeightField field;
  field.step = step_length(c, std::clamp(filter_width, 0.1f, 10.0f));
  const Vec3 ng = c.geometric_normal;
  const Vec3 helper = std::fabs(ng.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  field.dx = glm::normalize(glm::cross(helper, ng));
  field.dy = glm::cross(ng, field.dx);
  const geometry::SurfaceDerivatives derivatives = geometry::derivatives(*c.instance, c.hit);
  field.center = height(c);
  field.x = height(moved_context(c, derivatives, field.dx * field.step));
  field.y = height(moved_context(c, derivatives, field.dy * field.step));
  return field;
}

bool has_finite_heights(const HeightField& field) { return is_finite(field.center + field.x + field.y); }

// Returns the normal of the surface that lies `distance` times the heights above a surface with the normal `normal`, or
// 0 if it has no direction. The method is that of Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU" (2010).
Vec3 bend(const HeightField& field, const Vec3& normal, float distance) {
  const Vec3 rx = glm::cross(field.dy, normal), ry = glm::cross(normal, field.dx);
  const float det = glm::dot(field.dx, rx);
  const Vec3 gradient = (rx * (field.x - field.center) + ry * (field.y - field.center)) / field.step;
  return safe_normalize(normal * std::fabs(det) - gradient * (distance * sign(det)));
}

// Returns the vector in the space of the context's object.
Vec3 direction_to_local(const ShadeContext& c, const Vec3& v) {
  geometry::Placement storage;
  return Mat3(placement_of(c, &storage).to_local) * v;
}

// Returns the context at the same point of the surface before its vertices were displaced.
ShadeContext undisplaced_context(const ShadeContext& c, bool keeps_face_normal) {
  ShadeContext u = c;
  u.instance = c.instance->undisplaced.get();
  geometry::SurfacePoint point;
  geometry::place(*u.instance, c.hit, &point);
  u.position = point.position;
  Vec3 smooth;
  if (!keeps_face_normal || geometry::smooth_normal_at(*u.instance, c.hit, &smooth))
    u.normal = c.backfacing ? -point.shading_normal : point.shading_normal;
  u.geometric_normal = c.backfacing ? -point.geometric_normal : point.geometric_normal;
  return u;
}

}  // namespace

Vec3 bump(const Program& program, uint32_t block, const OpArgs& args, const ShadeContext& c) {
  const Vec3 own = safe_normalize(args.v(3));
  const Vec3 normal = own == Vec3(0.0f) ? c.normal : own;
  const float strength = std::max(args.f(0), 0.0f);
  if (!c.instance || !c.scene || strength == 0.0f || block == 0) return normal;
  const HeightField field =
      sample_heights(c, args.f(4), [&](const ShadeContext& moved) { return run_block(program, block, moved).x; });
  const Vec3 bent = bend(field, normal, args.mode & GRADUS_BUMP_INVERTED ? -args.f(1) : args.f(1));
  if (!has_finite_heights(field)) note_fault(c);
  const Vec3 mixed = bent == Vec3(0.0f) ? Vec3(0.0f) : safe_normalize(bent * strength + normal * (1.0f - strength));
  const Vec3 bumped = mixed == Vec3(0.0f) ? normal : mixed;
  return args.mode & GRADUS_BUMP_TILTED ? bsdf::keep_reflection_above(bumped, c.geometric_normal, c.wo) : bumped;
}

namespace {

// Returns the normal of a bump by displacement, whatever the version of Blender.
Vec3 bent_normal(const MaterialData& material, const ShadeContext& context) {
  const bool moved = material.displaces && context.instance->undisplaced;
  const ShadeContext c = moved ? undisplaced_context(context, material.bumps_moved_faces) : context;
  HeightField field = sample_heights(c, material.bump_filter_width, [&](const ShadeContext& at) {
    return glm::dot(Vec3(run_block(material.bump, 0, at)), c.normal);
  });
  if (!has_finite_heights(field)) note_fault(c);
  if (!material.displaces) {
    const Vec3 bent = bend(field, c.normal, 1.0f);
    return bent == Vec3(0.0f) ? c.normal : bent;
  }
  // As in Cycles, the slope is that of heights in world space over lengths in the object's space.
  field.dx = direction_to_local(c, field.dx);
  field.dy = direction_to_local(c, field.dy);
  const Vec3 bent = bend(field, normal_to_local(c, c.normal), 1.0f);
  return bent == Vec3(0.0f) ? c.normal : normal_to_world(c, bent);
}

}  // namespace

Vec3 displacement_bump(const MaterialData& material, const ShadeContext& c) {
  const Vec3 normal = bent_normal(material, c);
  const bool tilts = material.shading_normals == GRADUS_SHADING_NORMALS_BEFORE_3_6;
  return tilts ? bsdf::keep_reflection_above(normal, c.geometric_normal, c.wo) : normal;
}

}  // namespace gradus::shading
