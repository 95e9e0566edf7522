// The part of an area light from which a receiver gets light. A light with a limited spread emits into a cone of
// directions, so that a receiver only sees a circle of it, which is tiny for a narrow spread.
#pragma once

#include "base/types.h"
#include "light/analytic_light.h"

namespace gradus::light {

struct LitPart {
  enum class Shape : uint8_t {
    None,       // The receiver gets no light.
    Rectangle,  // Sampled uniformly in solid angle, or by area if that is small.
    Ellipse,    // The whole of an elliptical light, sampled uniformly by area.
    Circle,     // Sampled in proportion to the falloff of the spread.
  };

  Shape shape = Shape::None;
  // Points are relative to the light's position and along its axes. The rectangle lies around `centre`, the circle
  // around `foot`, the point of the light's plane that is nearest to the receiver.
  Vec2 centre{0.0f};
  Vec2 half_extent{0.0f};
  Vec2 foot{0.0f};
  float radius = kInfinity;

  // Returns whether a point is in the circle.
  bool is_seen(const Vec2& point) const { return !is_finite(radius) || glm::length(point - foot) < radius; }
  // Returns a point of the circle for u in [0, 1)², and the density of a point in 1/m².
  Vec2 sample_circle(const Vec2& u) const;
  float circle_density(const Vec2& point) const;
};

// Returns the part of a rectangular or elliptical light that emits towards `from`.
LitPart lit_part(const AnalyticLight& light, const Vec3& from);

}  // namespace gradus::light
