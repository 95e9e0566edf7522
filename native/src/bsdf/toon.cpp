// Toon lobes: a cone of constant brightness around the normal or the mirror direction, with an edge in which the
// brightness falls linearly with the angle. As in Cycles the value has no factor of the cosine, and a cone without an
// edge reflects all light unless it reaches below the surface.
#include <algorithm>
#include <cmath>

#include "base/trigonometry.h"
#include "bsdf/lobe.h"
#include "bsdf/shading_frame.h"

namespace gradus::bsdf {
namespace {

Vec3 cone_axis(const Lobe& lobe, const Vec3& wo) {
  return lobe.type == LobeType::DiffuseToon ? Vec3(0.0f, 0.0f, 1.0f) : Vec3(-wo.x, -wo.y, wo.z);
}

// Returns the half angle of the cone, edge included.
float cone_angle(const Lobe& lobe) { return std::min(lobe.alpha_x + lobe.alpha_y, 0.5f * kPi); }

// Returns 1 − cos(x) without the cancellation at small angles.
float one_minus_cosine(float x) {
  const float sine = std::sin(0.5f * x);
  return 2.0f * sine * sine;
}

bool is_seen(const Lobe& lobe, const Vec3& wo) { return lobe.type == LobeType::DiffuseToon || wo.z > 0.0f; }

}  // namespace

BsdfEval evaluate_toon(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t) {
  if (!(is_seen(lobe, wo) && wi.z > 0.0f)) {
    return {};
  }
  const float angle = 2.0f * std::asin(std::min(1.0f, 0.5f * glm::length(wi - cone_axis(lobe, wo))));
  const float largest = cone_angle(lobe);
  if (angle >= largest) {
    return {};
  }
  const float density = 0.5f * kInvPi / one_minus_cosine(largest);
  const float brightness = angle < lobe.alpha_x ? 1.0f : 1.0f - (angle - lobe.alpha_x) / lobe.alpha_y;
  return {lobe.weight * (brightness * density), density};
}

bool sample_toon(const Lobe& lobe, const Vec3& wo, float, const Vec2& u, uint8_t, Vec3* wi) {
  if (!is_seen(lobe, wo)) {
    return false;
  }
  const float depth = u.x * one_minus_cosine(cone_angle(lobe));  // 1 − cos
  const float radius = std::sqrt(depth * (2.0f - depth));
  const SineCosine phi = sine_cosine(2.0f * kPi * u.y);
  const Vec3 axis = cone_axis(lobe, wo);
  const Frame3 frame = make_frame(axis, perpendicular(axis));
  *wi = glm::normalize(frame.to_world(Vec3(radius * phi.cosine, radius * phi.sine, 1.0f - depth)));
  return wi->z > 0.0f;
}

}  // namespace gradus::bsdf
