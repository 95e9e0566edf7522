#include "scene/lamp.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

#include "scene/frame_basis.h"

namespace gradus {

namespace {

// Axes of the matrix without its scale; a matrix without volume leaves an arbitrary frame.
void set_axes(const GradusLight& d, Lamp* lamp) {
  const Mat4 m = glm::make_mat4(d.matrix);
  const float lengths[3] = {glm::length(Vec3(m[0])), glm::length(Vec3(m[1])), glm::length(Vec3(m[2]))};
  if (lengths[2] > 0.0f) lamp->shine = -Vec3(m[2]) / lengths[2];
  orthonormal_basis(lamp->shine, &lamp->axis_x, &lamp->axis_y);
  if (lengths[0] > 0.0f && lengths[1] > 0.0f) {
    lamp->axis_x = Vec3(m[0]) / lengths[0];
    lamp->axis_y = Vec3(m[1]) / lengths[1];
  }
}

void set_round(const GradusLight& d, Lamp* lamp) {
  lamp->is_spot = d.type == GRADUS_LIGHT_SPOT;
  lamp->spot_cosine = (d.flags & GRADUS_LIGHT_SPOT_COSINE) != 0;
  if (lamp->is_spot) {
    lamp->cos_cone = std::cos(0.5f * std::clamp(d.cone, 0.0f, kPi * 2));
    const float width = (1.0f - lamp->cos_cone) * std::max(d.blend, 0.0f);
    lamp->cone_slope = width > 0.0f ? 1.0f / width : kInfinity;
  }
  constexpr float kPointRadius = 1e-12f;  // m; below, the radiance would leave float's range
  if (!(d.radius > kPointRadius)) return;
  lamp->shape = d.flags & GRADUS_LIGHT_DISK_FACING ? Lamp::Shape::FacingDisk : Lamp::Shape::Sphere;
  lamp->radius = d.radius;
  lamp->area = kPi * d.radius * d.radius;
  lamp->intensity /= lamp->area;  // the radiance whose disk or sphere has this intensity
}

void set_area(const GradusLight& d, Lamp* lamp) {
  const bool round = d.type == GRADUS_LIGHT_ELLIPSE;
  lamp->shape = round ? Lamp::Shape::Ellipse : Lamp::Shape::Rectangle;
  lamp->half_width = 0.5f * std::fabs(d.size[0]);
  lamp->half_height = 0.5f * std::fabs(d.size[1]);
  lamp->area = (round ? kPi : 4.0f) * lamp->half_width * lamp->half_height;
  if (d.spread >= kPi) return;
  // Falls with the tangent, as behind a grid of slats; scaled so that the flux stays: the integral over the hemisphere of
  // cos(x) (1 - tan(x)/tan(a)) is (tan(a) - a) / tan(a) of that of cos(x).
  const float a = 0.5f * std::max(d.spread, kPi / 180.0f);
  lamp->tan_spread = std::tan(a);
  lamp->spread_scale = 1.0f / (lamp->tan_spread - a);
}

void set_sun(const GradusLight& d, Lamp* lamp) {
  const float half = 0.5f * std::clamp(d.angle, 0.0f, kPi);
  lamp->shape = half > 1e-6f ? Lamp::Shape::Cone : Lamp::Shape::Direction;
  if (lamp->dirac()) return;
  const float s = std::sin(half), h = std::sin(0.5f * half);
  lamp->one_minus_cos_sun = 2.0f * h * h;
  const bool given = is_finite(d.sun_radiance_per_irradiance) && d.sun_radiance_per_irradiance > 0.0f;
  lamp->intensity *= given ? d.sun_radiance_per_irradiance : 1.0f / (kPi * s * s);
}

}  // namespace

bool is_finite_light(const GradusLight& d) {
  float sum = d.radius + d.angle + d.size[0] + d.size[1] + d.spread + d.cone + d.blend;
  for (const float m : d.matrix) sum += m - m;
  for (const float s : d.strength) sum += s - s;
  return is_finite(sum);
}

bool make_lamp(const GradusLight& d, const Vec3& origin, Lamp* lamp) {
  *lamp = Lamp();
  if (!is_finite_light(d)) return false;
  lamp->casts_shadow = !(d.flags & GRADUS_LIGHT_NO_SHADOW);
  lamp->multiple_importance = !(d.flags & GRADUS_LIGHT_NO_MIS);
  lamp->visibility = d.visibility;
  lamp->max_bounces = d.max_bounces;
  lamp->pass_index = d.pass_index;
  for (int i = 0; i < 3; ++i) lamp->position[i] = float(double(d.matrix[12 + i]) - double(origin[i]));
  lamp->intensity = Rgb(d.strength[0], d.strength[1], d.strength[2]);
  set_axes(d, lamp);
  if (d.type == GRADUS_LIGHT_SUN) set_sun(d, lamp);
  if (d.type == GRADUS_LIGHT_POINT || d.type == GRADUS_LIGHT_SPOT) set_round(d, lamp);
  if (d.type == GRADUS_LIGHT_RECTANGLE || d.type == GRADUS_LIGHT_ELLIPSE) set_area(d, lamp);
  const bool sized = lamp->shape != Lamp::Shape::Rectangle && lamp->shape != Lamp::Shape::Ellipse;
  return !is_black(lamp->intensity) && is_finite(lamp->intensity) && (sized || (lamp->area > 0.0f && is_finite(lamp->area)));
}

LightBounds lamp_bounds(const Lamp& lamp) {
  LightBounds b;
  const bool flat = lamp.shape == Lamp::Shape::Rectangle || lamp.shape == Lamp::Shape::Ellipse;
  const Vec3 extent = flat ? glm::abs(lamp.axis_x) * lamp.half_width + glm::abs(lamp.axis_y) * lamp.half_height : Vec3(lamp.radius);
  b.lower = lamp.position - extent;
  b.upper = lamp.position + extent;
  b.axis = lamp.shine;
  b.power = std::min(mean_component(glm::abs(lamp.intensity)), 1e30f) * (lamp.area > 0.0f ? lamp.area : 1.0f);
  b.cos_normals = flat ? 1.0f : -1.0f;
  if (lamp.is_spot) {
    b.cos_normals = lamp.cos_cone;
    b.cos_emission = 0.9999f;  // nothing leaves the cone
  }
  // Intensity along the axis grows as the spread narrows.
  if (flat && is_finite(lamp.tan_spread)) {
    b.power = std::min(b.power * lamp.tan_spread * lamp.spread_scale, 1e30f);
    b.cos_emission = 1.0f / std::sqrt(1.0f + lamp.tan_spread * lamp.tan_spread);
  }
  return b;
}

}  // namespace gradus
