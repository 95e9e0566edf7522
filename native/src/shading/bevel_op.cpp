// The Bevel node. It averages normals around the point by the sampling of King et al., "BSSRDF Importance Sampling"
// (2013): rays through a disk along one of three axes, which are combined by multiple importance sampling.
#include "shading/context_ops.h"
#include "shading/random_rays.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// The falloff over distance is a cubic: (1 − r / radius)³, which the density on the disk follows.
float falloff(float r, float radius) {
  const float x = 1.0f - r / radius;
  return x > 0.0f ? x * x * x : 0.0f;
}

// Returns the share of the radius within which lies the share `u` of the cubic over the disk: the root of
// 10x² − 20x³ + 15x⁴ − 4x⁵ = u, by Newton's method within a shrinking interval.
float disk_radius(float u) {
  float low = 0.0f, high = 1.0f, x = std::sqrt(u) * 0.5f;
  for (int i = 0; i < 12; ++i) {
    const float value = x * x * (10.0f + x * (-20.0f + x * (15.0f - 4.0f * x))) - u;
    (value < 0.0f ? low : high) = x;
    const float slope = 20.0f * x * (1.0f - x) * (1.0f - x) * (1.0f - x);
    const float next = x - value / slope;
    x = next > low && next < high ? next : 0.5f * (low + high);
  }
  return x;
}

// An axis along which rays are shot, with the probabilities of the three axes as seen from it.
struct Probe {
  Vec3 along, x, y;
  float p_along = 0.5f, p_x = 0.25f, p_y = 0.25f;
};

// Chooses the normal with probability 1/2, or one of two tangents. Stretches *u to the full range again.
Probe choose_axis(const Vec3& n, float* u) {
  const Vec3 helper = std::fabs(n.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 t = glm::normalize(glm::cross(helper, n)), b = glm::cross(n, t);
  if (*u < 0.5f) {
    *u *= 2.0f;
    return {n, t, b, 0.5f, 0.25f, 0.25f};
  }
  const bool second = *u >= 0.75f;
  *u = (*u - (second ? 0.75f : 0.5f)) * 4.0f;
  return second ? Probe{b, n, t, 0.25f, 0.5f, 0.25f} : Probe{t, n, b, 0.25f, 0.5f, 0.25f};
}

// Returns the weight of the axis by the power heuristic over its density, for a surface with the normal `n`.
float axis_weight(const Probe& probe, const Vec3& n) {
  const float a = probe.p_along * std::fabs(glm::dot(probe.along, n));
  const float x = probe.p_x * std::fabs(glm::dot(probe.x, n));
  const float y = probe.p_y * std::fabs(glm::dot(probe.y, n));
  return a / (a * a + x * x + y * y);
}

// More surfaces than these on one ray are left out.
constexpr int kMaxHits = 64;

// Returns the weighted sum of the normals that a probe through a point of the disk meets.
Vec3 sum_of_normals(const ShadeContext& c, float radius, Vec2 u) {
  const Probe probe = choose_axis(c.geometric_normal, &u.x);
  const float r = disk_radius(u.y) * radius, phi = 2.0f * kPi * u.x;
  const float height = std::sqrt(std::max(radius * radius - r * r, 0.0f));
  const Vec3 top = c.position + probe.along * height + (probe.x * std::cos(phi) + probe.y * std::sin(phi)) * r;
  Ray ray{top, 0.0f, -probe.along, 2.0f * height, c.hit.time};
  Vec3 sum(0.0f);
  geometry::Hit hit;
  for (int k = 0; k < kMaxHits && c.scene->intersect_instance(ray, c.hit.instance, &hit); ++k) {
    const geometry::SurfacePoint point = c.scene->surface_point(hit);
    const float weight = falloff(glm::distance(point.position, c.position), radius) / falloff(r, radius);
    sum += point.shading_normal * (weight * axis_weight(probe, point.geometric_normal));
    // The ray may have passed other instances, so its rest is measured from the hit.
    const float rest = 2.0f * height - glm::dot(point.position - top, ray.direction);
    ray = Ray{geometry::offset_origin(point, ray.direction), 0.0f, ray.direction, rest, c.hit.time};
  }
  return is_finite(sum) ? sum : Vec3(0.0f);
}

// Returns the mean normal, on the side of the viewer. Cycles leaves out the node for rays that are spread widely, where
// a mean normal shows no difference.
Vec3 mean_normal(const ResourceArgs& args, const ShadeContext& c) {
  const float radius = args.f(0);
  const uint32_t count = ray_count(args);
  // There is nothing to trace while vertices are displaced.
  if (!c.scene || !c.scene->accelerator || !c.instance || !(radius > 0.0f) || count == 0) return c.normal;
  const RandomPoints points(c, count);
  Vec3 sum(0.0f);
  for (uint32_t i = 0; i < count; ++i) sum += sum_of_normals(c, radius, points[i]);
  const Vec3 mean = safe_normalize(sum);
  return mean == Vec3(0.0f) ? c.normal : c.backfacing ? -mean : mean;
}

}  // namespace

void bevel_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const Vec3 own = args.v(1);
  const Vec3 mean = mean_normal(args, c);
  const Vec3 bent = own == Vec3(0.0f) ? mean : safe_normalize(own + mean - c.normal);
  out[0] = value(bent == Vec3(0.0f) ? c.normal : bent);
}

}  // namespace gradus::shading
