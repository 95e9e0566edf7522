#include "shading/interpreter.h"
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
  const Vec3 p = glm::abs(c.position);
  float distance = c.scene->radius;
  if (c.scene->has_camera) {
    const float* m = c.scene->camera.matrix;
    distance = glm::distance(c.position, Vec3(m[12], m[13], m[14]));
    if (c.scene->camera.type == GRADUS_CAMERA_ORTHOGRAPHIC)
      distance = c.scene->camera.window[1] - c.scene->camera.window[0];
  }
  return std::max(std::max(distance * kPixelAngle * filter_width, kSmallestStep * max_component(p)), 1e-7f);
}

}  // namespace

// The method is that of Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU" (2010).
Vec3 bump(const Program& program, uint32_t block, const OpArgs& args, const ShadeContext& c) {
  const Vec3 own = safe_normalize(args.v(3));
  const Vec3 normal = own == Vec3(0.0f) ? c.normal : own;
  const float strength = std::max(args.f(0), 0.0f);
  if (!c.instance || !c.scene || strength == 0.0f || block == 0) return normal;
  const float step = step_length(c, std::clamp(args.f(4), 0.1f, 10.0f));
  const Vec3 ng = c.geometric_normal;
  const Vec3 helper = std::fabs(ng.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 dx = glm::normalize(glm::cross(helper, ng)), dy = glm::cross(ng, dx);
  const geometry::SurfaceDerivatives derivatives = c.scene->derivatives(c.hit);
  const float h = run_block(program, block, c).x;
  const float hx = run_block(program, block, moved_context(c, derivatives, dx * step)).x;
  const float hy = run_block(program, block, moved_context(c, derivatives, dy * step)).x;
  const Vec3 rx = glm::cross(dy, normal), ry = glm::cross(normal, dx);
  const float det = glm::dot(dx, rx);
  const Vec3 gradient = (rx * (hx - h) + ry * (hy - h)) / step;
  const float distance = args.mode == 1 ? -args.f(1) : args.f(1);
  const Vec3 bent = safe_normalize(normal * std::fabs(det) - gradient * (distance * sign(det)));
  if (bent == Vec3(0.0f)) return normal;
  const Vec3 mixed = safe_normalize(bent * strength + normal * (1.0f - strength));
  return mixed == Vec3(0.0f) ? normal : mixed;
}

}  // namespace gradus::shading
