// Analytic lights: point, spot, area and sun lights, which are not part of a mesh. Units are those of gradus.h.
// Strengths have the same meaning as in Cycles.
#pragma once

#include <cmath>
#include <memory>

#include "base/types.h"
#include "geometry/light_links.h"
#include "geometry/object_data.h"
#include "gradus/gradus.h"
#include "light/light_sampling.h"
#include "light/light_tree.h"

namespace gradus::light {

// An analytic light in the snapshot's internal space, with precomputed values for sampling.
struct AnalyticLight {
  enum class Shape : uint8_t { Point, Sphere, FacingDisk, Rectangle, Ellipse, Direction, Cone };

  Shape shape = Shape::Point;
  bool is_spot = false;
  bool spot_cosine = false;
  bool casts_shadow = true;
  bool multiple_importance =
      true;  // False: only light sampling finds the light, and rays pass through it, as in Cycles.
  uint32_t visibility = GRADUS_VISIBLE_ALL;
  uint32_t max_bounces = UINT32_MAX;
  uint32_t light_group = 0;  // index + 1 in Snapshot::channels; 0: none
  geometry::EmitterLinks links;
  // Index of the snapshot's material whose emission multiplies `intensity`; UINT32_MAX: the factor is 1.
  uint32_t material = UINT32_MAX;
  std::shared_ptr<const geometry::ObjectData> object;  // what the material reads of the light; null without a material
  bool is_object = true;                               // the material reads more than a random number and normals
  bool world_uv = false;                               // see GRADUS_LIGHT_WORLD_UV
  Vec3 position{0.0f};
  Vec3 axis_x{1, 0, 0};
  Vec3 axis_y{0, 1, 0};
  Vec3 emission_direction{0, 0, -1};  // Unit direction of emission, away from the light.
  Rgb intensity{0.0f};                // Point: W/sr; direction: irradiance in W/m²; every light with extent: radiance.
  float radius = 0.0f;
  float half_width = 0.0f, half_height = 0.0f;
  float area = 0.0f;  // Area in m² of a rectangle, ellipse, disk, or of a sphere's cross section.
  // Maps directions to the space of a spot, in which its cone is circular and around z. The scale of its object makes
  // the cone elliptical.
  Mat3 spot_space{1.0f};
  float cos_cone = -1.0f;          // Cosine of half a spot's cone angle in that space.
  float cone_slope = 0.0f;         // 1 / ((1 - cos_cone)·blend) of a spot.
  float tan_spread = kInfinity;    // Tangent of half an area light's spread; infinite: no limit.
  float spread_scale = 1.0f;       // Factor that keeps the flux when the spread is limited.
  float one_minus_cos_sun = 0.0f;  // 1 - cos of half a sun's angle.

  // Returns whether the light is a single position or direction, without extent.
  bool dirac() const { return shape == Shape::Point || shape == Shape::Direction; }
  // Returns whether a BSDF sample can hit the light.
  bool found_by_rays() const { return !dirac() && multiple_importance; }
  // Returns whether an area light has a point, given relative to its position and along its axes.
  bool covers(const Vec2& p) const {
    const Vec2 q(p.x / half_width, p.y / half_height);
    return shape == Shape::Ellipse ? glm::dot(q, q) <= 1.0f : std::fabs(q.x) <= 1.0f && std::fabs(q.y) <= 1.0f;
  }
  bool at_infinity() const { return shape == Shape::Direction || shape == Shape::Cone; }
};

// Returns whether all numbers of a light description are finite.
bool is_finite_light(const GradusLight& desc);
// Fills `light` from its description; positions become relative to `origin`. Returns false if the light emits nothing:
// values that are not finite, no strength, or an area light without area.
bool make_analytic_light(const GradusLight& desc, const Vec3& origin, AnalyticLight* light);
// Returns the bounds of a light that is not at infinity.
LightBounds light_bounds(const AnalyticLight& light);

// Samples a point of the light for a receiver at `from`, with u in [0, 1)². `point` must have its default value.
// Returns false if the light does not emit towards the receiver. `solid_angle` receives the solid angle in which the
// point is uniform, or 0 if it is sampled differently; evaluate_analytic_light() takes it.
bool sample_analytic_light(const AnalyticLight& light, const Vec3& from, const Vec2& u, LightPoint* point,
                           float* solid_angle);
// Evaluates a point of the light as seen from `from`: direction, distance, cosine, radiance (without the light's
// material), and the density of sample_analytic_light() in solid angle (1 if Dirac). `solid_angle` is the value that
// sample_analytic_light() returned for the same receiver, which saves its computation; null: it is computed here.
// `view` must have its default value.
void evaluate_analytic_light(const AnalyticLight& light, const LightPoint& point, const Vec3& from,
                             const float* solid_angle, LightEvaluation* view);
// Intersects a ray with a light that has extent, and writes the point and the distance along the ray. Returns false if
// there is no intersection between t_min and t_max.
bool intersect_light(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance);

}  // namespace gradus::light
