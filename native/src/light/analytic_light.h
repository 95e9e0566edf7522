// Lights: lights that are not surfaces. Units as in gradus.h, strengths as in Cycles.
#pragma once

#include "base/types.h"
#include "gradus/gradus.h"
#include "light/light_sampling.h"
#include "light/light_tree.h"

namespace gradus::light {

// In the snapshot's internal space, with what sampling needs worked out.
struct AnalyticLight {
  enum class Shape : uint8_t { Point, Sphere, FacingDisk, Rectangle, Ellipse, Direction, Cone };

  Shape shape = Shape::Point;
  bool is_spot = false;
  bool spot_cosine = false;
  bool casts_shadow = true;
  bool multiple_importance = true;  // off: rays pass through it, as in Cycles
  uint32_t visibility = GRADUS_VISIBLE_ALL;
  uint32_t max_bounces = UINT32_MAX;
  int32_t pass_index = 0;
  uint32_t material = UINT32_MAX;  // index in the snapshot whose emission multiplies; UINT32_MAX: constant
  Vec3 position{0.0f};
  Vec3 axis_x{1, 0, 0};
  Vec3 axis_y{0, 1, 0};
  Vec3 emission_direction{0, 0, -1};  // where it shines to
  Rgb intensity{0.0f};                // point: W/sr; direction: W/m2; all with extent: radiance
  float radius = 0.0f;
  float half_width = 0.0f, half_height = 0.0f;
  float area = 0.0f;        // of rectangle, ellipse, disk
  float cos_cone = -1.0f;   // spot
  float cone_slope = 0.0f;  // 1 / ((1 - cos_cone)·blend)
  float tan_spread = kInfinity;
  float spread_scale = 1.0f;
  float one_minus_cos_sun = 0.0f;  // of half the angle

  bool dirac() const { return shape == Shape::Point || shape == Shape::Direction; }
  bool found_by_rays() const { return !dirac() && multiple_importance; }
  bool at_infinity() const { return shape == Shape::Direction || shape == Shape::Cone; }
};

bool is_finite_light(const GradusLight& desc);
// False: it cannot shine (non-finite values, no strength, no area).
bool make_analytic_light(const GradusLight& desc, const Vec3& origin, AnalyticLight* light);
// Of lights that are not at infinity.
LightBounds light_bounds(const AnalyticLight& light);

// A point of the light as sampled from `from`, written to a fresh one; false: it does not shine there. solid_angle: see
// evaluate_analytic_light().
bool sample_analytic_light(const AnalyticLight& light, const Vec3& from, const Vec2& u, LightPoint* point,
                           float* solid_angle);
// Direction, distance, cosine, radiance (material left out), and the density of sample_analytic_light() in solid angle
// (1 if Dirac). solid_angle: what sample_analytic_light() found from there, so that it need not be found again; 0: the
// light is sampled in another way. view: a fresh one.
void evaluate_analytic_light(const AnalyticLight& light, const LightPoint& point, const Vec3& from,
                             const float* solid_angle, LightEvaluation* view);
// Where a ray crosses a light with extent; false: nowhere between t_min and t_max.
bool intersect_light(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance);

}  // namespace gradus::light
