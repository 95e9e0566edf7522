#include "light/lit_part.h"

#include <algorithm>
#include <cmath>

namespace gradus::light {

namespace {

// Spreads up to 2·atan(1.5) = 113° are sampled by their falloff. For wider ones, solid angle matters more: the variance
// of light on a parallel receiver is 0.58 times the squared mean for both at a tangent of 2, and 0.1 against 0.66 at 1.
constexpr float kNarrowTangent = 1.5f;

}  // namespace

LitPart lit_part(const AnalyticLight& light, const Vec3& from) {
  const bool round = light.shape == AnalyticLight::Shape::Ellipse;
  const Vec2 extent(light.half_width, light.half_height);
  LitPart part;
  part.shape = round ? LitPart::Shape::Ellipse : LitPart::Shape::Rectangle;
  part.half_extent = extent;
  const Vec3 to_receiver = from - light.position;
  const float distance = glm::dot(to_receiver, light.emission_direction);
  if (!(distance > 0.0f)) return {};
  if (!is_finite(light.tan_spread)) return part;

  part.foot = Vec2(glm::dot(to_receiver, light.axis_x), glm::dot(to_receiver, light.axis_y));
  part.radius = distance * light.tan_spread;
  const Vec2 lower = glm::max(part.foot - part.radius, -extent), upper = glm::min(part.foot + part.radius, extent);
  if (!(lower.x < upper.x && lower.y < upper.y)) return {};
  const Vec2 size = upper - lower;
  const float area = size.x * size.y;
  // With less than half of the circle's square on the light, too many points of the circle would miss it.
  if (light.tan_spread <= kNarrowTangent && area >= 2.0f * part.radius * part.radius) {
    part.shape = LitPart::Shape::Circle;
  } else if (!round || area < light.area) {
    part.shape = LitPart::Shape::Rectangle;
    part.centre = 0.5f * (lower + upper);
    part.half_extent = 0.5f * size;
  }
  return part;
}

// The falloff is linear in the distance r from the centre, so that the density is 3 (R - r) / (π R³), and the
// distribution of x = r/R is the smoothstep 3x² - 2x³, whose inverse is 1/2 - sin(asin(1 - 2u) / 3).
Vec2 LitPart::sample_circle(const Vec2& u) const {
  const float r =
      radius * std::max(0.5f - std::sin(std::asin(std::clamp(1.0f - 2.0f * u.x, -1.0f, 1.0f)) / 3.0f), 0.0f);
  const float phi = 2.0f * kPi * u.y;
  return foot + r * Vec2(std::cos(phi), std::sin(phi));
}

float LitPart::circle_density(const Vec2& point) const {
  const float r = glm::length(point - foot) / radius;
  return 3.0f * std::max(1.0f - r, 0.0f) / (kPi * radius * radius);
}

}  // namespace gradus::light
