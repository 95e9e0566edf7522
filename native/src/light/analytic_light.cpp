#include "light/analytic_light.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

#include "base/orthonormal_basis.h"

namespace gradus::light {

namespace {

// Sets the light's axes from its matrix, without scale. A matrix without volume gives an arbitrary orthonormal frame.
void set_axes(const GradusLight& d, AnalyticLight* light) {
  const Mat4 m = glm::make_mat4(d.matrix);
  const float lengths[3] = {glm::length(Vec3(m[0])), glm::length(Vec3(m[1])), glm::length(Vec3(m[2]))};
  if (lengths[2] > 0.0f) light->emission_direction = -Vec3(m[2]) / lengths[2];
  orthonormal_basis(light->emission_direction, &light->axis_x, &light->axis_y);
  if (lengths[0] > 0.0f && lengths[1] > 0.0f) {
    light->axis_x = Vec3(m[0]) / lengths[0];
    light->axis_y = Vec3(m[1]) / lengths[1];
  }
}

// Sets the space of a spot from the light's matrix, or from its axes if the matrix has no volume.
void set_spot_space(const GradusLight& d, AnalyticLight* light) {
  Mat3 axes(glm::make_mat4(d.matrix));
  if (d.flags & GRADUS_LIGHT_ROUND_CONE)
    for (int i = 0; i < 3; ++i) axes[i] = glm::normalize(axes[i]);
  axes[2] = -axes[2];
  light->spot_space = glm::inverse(axes);
  float sum = 0.0f;
  for (int i = 0; i < 3; ++i) sum += glm::dot(light->spot_space[i], light->spot_space[i]);
  if (!(sum > 0.0f) || !is_finite(sum))
    light->spot_space = glm::transpose(Mat3(light->axis_x, light->axis_y, light->emission_direction));
}

// Returns a lower bound of the cosine between the axis of a spot's cone and any direction in the cone.
float cosine_around_spot(const AnalyticLight& light) {
  const Mat3 axes = glm::inverse(light.spot_space);
  const float x = glm::length(axes[0]), y = glm::length(axes[1]), z = glm::length(axes[2]);
  const auto is_skewed = [](const Vec3& a, const Vec3& b, float lengths) {
    return !(std::fabs(glm::dot(a, b)) <= 1e-4f * lengths);
  };
  if (is_skewed(axes[0], axes[2], x * z) || is_skewed(axes[1], axes[2], y * z) || is_skewed(axes[0], axes[1], x * y))
    return -1.0f;
  if (std::fabs(x - z) <= 1e-4f * z && std::fabs(y - z) <= 1e-4f * z) return light.cos_cone;
  if (light.cos_cone <= 0.0f) return -1.0f;
  const float tangent = std::sqrt(1.0f - light.cos_cone * light.cos_cone) / light.cos_cone * std::max(x, y) / z;
  return 1.0f / std::sqrt(1.0f + tangent * tangent);
}

// Sets the fields of a point or spot light.
void set_round(const GradusLight& d, AnalyticLight* light) {
  light->is_spot = d.type == GRADUS_LIGHT_SPOT;
  light->spot_cosine = (d.flags & GRADUS_LIGHT_SPOT_COSINE) != 0;
  if (light->is_spot) {
    set_spot_space(d, light);
    light->cos_cone = std::cos(0.5f * std::clamp(d.cone, 0.0f, kPi * 2));
    const float width = (1.0f - light->cos_cone) * std::max(d.blend, 0.0f);
    light->cone_slope = width > 0.0f ? 1.0f / width : kInfinity;
  }
  constexpr float kPointRadius = 1e-12f;  // In metres. With a smaller radius, the radiance would overflow a float.
  if (!(d.radius > kPointRadius)) return;
  light->shape = d.flags & GRADUS_LIGHT_DISK_FACING ? AnalyticLight::Shape::FacingDisk : AnalyticLight::Shape::Sphere;
  light->radius = d.radius;
  light->area = kPi * d.radius * d.radius;
  light->intensity /= light->area;  // The radiance of a disk or sphere with this intensity.
}

// Sets the fields of a rectangular or elliptical area light.
void set_area(const GradusLight& d, AnalyticLight* light) {
  const bool round = d.type == GRADUS_LIGHT_ELLIPSE;
  light->shape = round ? AnalyticLight::Shape::Ellipse : AnalyticLight::Shape::Rectangle;
  light->half_width = 0.5f * std::fabs(d.size[0]);
  light->half_height = 0.5f * std::fabs(d.size[1]);
  light->area = (round ? kPi : 4.0f) * light->half_width * light->half_height;
  if (d.spread >= kPi) return;
  // The radiance falls linearly with the tangent of the angle, as behind a grid of slats. The scale keeps the flux: the
  // integral over the hemisphere of cos(x) (1 - tan(x)/tan(a)) is (tan(a) - a) / tan(a) times that of cos(x).
  constexpr double kMinimumSpread = kPi / 1800.0;
  const double a = 0.5 * std::max(double(d.spread), kMinimumSpread), tangent = std::tan(a);
  light->tan_spread = float(tangent);
  light->spread_scale = float(1.0 / (tangent - a));  // a difference that would be lost in single precision
}

// Sets the fields of a sun light.
void set_sun(const GradusLight& d, AnalyticLight* light) {
  const float half = 0.5f * std::clamp(d.angle, 0.0f, kPi);
  light->shape = half > 1e-6f ? AnalyticLight::Shape::Cone : AnalyticLight::Shape::Direction;
  if (light->dirac()) return;
  const float s = std::sin(half), h = std::sin(0.5f * half);
  light->one_minus_cos_sun = 2.0f * h * h;
  const bool given = is_finite(d.sun_radiance_per_irradiance) && d.sun_radiance_per_irradiance > 0.0f;
  light->intensity *= given ? d.sun_radiance_per_irradiance : 1.0f / (kPi * s * s);
}

}  // namespace

bool is_finite_light(const GradusLight& d) {
  float sum = d.radius + d.angle + d.size[0] + d.size[1] + d.spread + d.cone + d.blend;
  for (const float m : d.matrix) sum += m - m;
  for (const float s : d.strength) sum += s - s;
  return is_finite(sum);
}

bool make_analytic_light(const GradusLight& d, const Vec3& origin, AnalyticLight* light) {
  *light = AnalyticLight();
  if (!is_finite_light(d)) return false;
  light->casts_shadow = !(d.flags & GRADUS_LIGHT_NO_SHADOW);
  light->multiple_importance = !(d.flags & GRADUS_LIGHT_NO_MIS);
  light->visibility = d.visibility;
  light->is_object = !(d.flags & GRADUS_LIGHT_NO_OBJECT);
  light->world_uv = (d.flags & GRADUS_LIGHT_WORLD_UV) != 0;
  light->max_bounces = d.max_bounces;
  light->light_group = d.light_group;
  light->links = geometry::emitter_links(d.receiver_mask, d.blocker_mask);
  for (int i = 0; i < 3; ++i) light->position[i] = float(double(d.matrix[12 + i]) - double(origin[i]));
  light->intensity = Rgb(d.strength[0], d.strength[1], d.strength[2]);
  set_axes(d, light);
  if (d.type == GRADUS_LIGHT_SUN) set_sun(d, light);
  if (d.type == GRADUS_LIGHT_POINT || d.type == GRADUS_LIGHT_SPOT) set_round(d, light);
  if (d.type == GRADUS_LIGHT_RECTANGLE || d.type == GRADUS_LIGHT_ELLIPSE) set_area(d, light);
  const bool sized = light->shape != AnalyticLight::Shape::Rectangle && light->shape != AnalyticLight::Shape::Ellipse;
  return !is_black(light->intensity) && is_finite(light->intensity) &&
         (sized || (light->area > 0.0f && is_finite(light->area)));
}

LightBounds light_bounds(const AnalyticLight& light) {
  LightBounds b;
  const bool flat = light.shape == AnalyticLight::Shape::Rectangle || light.shape == AnalyticLight::Shape::Ellipse;
  const Vec3 extent = flat ? glm::abs(light.axis_x) * light.half_width + glm::abs(light.axis_y) * light.half_height
                           : Vec3(light.radius);
  b.lower = light.position - extent;
  b.upper = light.position + extent;
  b.axis = light.emission_direction;
  b.power = std::min(mean_component(glm::abs(light.intensity)), 1e30f) * (light.area > 0.0f ? light.area : 1.0f);
  b.cos_normals = flat ? 1.0f : -1.0f;
  if (light.is_spot) {
    b.cos_normals = cosine_around_spot(light);
    b.cos_emission = 0.9999f;  // A spot emits nothing outside its cone.
  }
  // The intensity along the axis grows as the spread narrows.
  if (flat && is_finite(light.tan_spread)) {
    b.power = std::min(b.power * light.tan_spread * light.spread_scale, 1e30f);
    b.cos_emission = 1.0f / std::sqrt(1.0f + light.tan_spread * light.tan_spread);
  }
  return b;
}

}  // namespace gradus::light
