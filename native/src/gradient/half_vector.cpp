#include "gradient/half_vector.h"

#include <algorithm>
#include <cmath>

#include "bsdf/lobe.h"

namespace gradus::gradient {

namespace {

// Minimum |η − 1| of a refraction. Below it the direction hardly changes, and the half-vector is undefined.
constexpr float kMinBend = 1e-3f;
// Minimum length of wo + η wi and wo + wi for which the normalised vector is accurate in float.
constexpr float kMinLength = 1e-4f;

ShiftedDirection failed(ShiftFailure failure) { return {Vec3(0.0f), 0.0f, failure}; }

ShiftedDirection copy_reflection(const HalfVectorFrame& base, const Vec3& wi, const HalfVectorFrame& offset) {
  const Vec3 sum = base.wo + wi;
  const float length = glm::length(sum);
  if (!(length > kMinLength)) {
    return failed(ShiftFailure::Jacobian);
  }
  const Vec3 h = sum / length;
  const Vec3 shifted = rotate_between(base.normal, offset.normal, h);
  // The half-vector bisects the angle between the unit vectors wo and wi, so its cosine with wi is half of the length.
  // The dot product of h and wi would have the rounding error of h, which is large at grazing angles.
  const float cos_base = 0.5f * length;
  const float cos_shifted = glm::dot(shifted, offset.wo);
  if (!(cos_shifted > 0.0f)) {
    return failed(ShiftFailure::Side);  // the inverse shift would return -h
  }
  return {glm::normalize(2.0f * cos_shifted * shifted - offset.wo), cos_shifted / cos_base, ShiftFailure::None};
}

// Computes the direction wi of wo refracted at the microfacet with normal h, which lies on the side where wo + eta·wi
// points. Returns false on total internal reflection.
bool refract_through(const Vec3& wo, const Vec3& h, float eta, Vec3* wi) {
  const float cos_o = glm::dot(wo, h);
  const float under_root = 1.0f - (1.0f - cos_o * cos_o) / (eta * eta);
  if (!(under_root > 0.0f)) {
    return false;
  }
  // Component of wi along h. Its sign is opposite to that of wo.
  const float cos_i = cos_o > 0.0f ? -std::sqrt(under_root) : std::sqrt(under_root);
  *wi = glm::normalize(h * cos_i - (wo - h * cos_o) / eta);
  return true;
}

ShiftedDirection copy_refraction(const HalfVectorFrame& base, const Vec3& wi, const HalfVectorFrame& offset) {
  if (std::fabs(base.eta - 1.0f) < kMinBend || std::fabs(offset.eta - 1.0f) < kMinBend) {
    return failed(ShiftFailure::Jacobian);
  }
  // The half-vector points to the denser medium, while the normals of both frames lie on the side of wo. So two
  // vertices cannot share a half-vector if one path enters the denser medium and the other leaves it.
  if ((base.eta > 1.0f) != (offset.eta > 1.0f)) {
    return failed(ShiftFailure::Side);
  }
  const Vec3 sum = base.wo + base.eta * wi;
  const float length = glm::length(sum);
  if (!(length > kMinLength)) {
    return failed(ShiftFailure::Jacobian);
  }
  const Vec3 h = sum / length;
  const Vec3 shifted = rotate_between(base.normal, offset.normal, h);
  // wo and wi lie on different sides of h, and wo must lie on the same side of h on both paths.
  const float cos_o = glm::dot(base.wo, h);
  const float cos_o_shifted = glm::dot(offset.wo, shifted);
  if (!(cos_o * cos_o_shifted > 0.0f)) {
    return failed(ShiftFailure::Side);
  }
  ShiftedDirection result;
  if (!refract_through(offset.wo, shifted, offset.eta, &result.wi)) {
    return failed(ShiftFailure::TotalReflection);
  }
  const float length_shifted = glm::length(offset.wo + offset.eta * result.wi);
  const float inverse_base = base.eta * base.eta * std::fabs(glm::dot(wi, h)) / (length * length);
  const float inverse_shifted =
      offset.eta * offset.eta * std::fabs(glm::dot(result.wi, shifted)) / (length_shifted * length_shifted);
  result.jacobian = inverse_base / inverse_shifted;
  return result;
}

// Copies an event of a Dirac lobe. Its choice is discrete, so the Jacobian is 1.
ShiftedEvent copy_dirac_event(const path::ScatterEvent& event, const path::Vertex& y) {
  const bsdf::Closures& closures = y.shade.closures;
  const int lobe = bsdf::dirac_lobe(closures, event.scatter_class, event.dirac_rank);
  bsdf::BsdfSample sample;
  if (lobe < 0) {
    return failed_event(ShiftFailure::Class);
  }
  if (!closures.evaluate_dirac(lobe, y.wo, event.sample.transmitted, &sample)) {
    return failed_event(event.sample.transmitted ? ShiftFailure::TotalReflection : ShiftFailure::Class);
  }
  return weigh_event(event, sample.wi, sample.value, closures.class_probability(event.scatter_class) * sample.pdf,
                     1.0f);
}

}  // namespace

Vec3 rotate_between(const Vec3& from, const Vec3& to, const Vec3& v) {
  // Rodrigues' formula with the axis from × to (Möller and Hughes 1999).
  const float c = glm::dot(from, to);
  const Vec3 axis = glm::cross(from, to);
  if (c < -0.99999f) {
    // The normals are opposite. Use the half turn about an axis that does not depend on the order of the two normals.
    const Vec3 a = std::fabs(from.x) > 0.5f ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    const Vec3 u = glm::normalize(a - from * glm::dot(a, from));
    return 2.0f * glm::dot(u, v) * u - v;
  }
  return c * v + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1.0f + c));
}

ShiftedDirection copy_half_vector(const HalfVectorFrame& base, const Vec3& wi, const HalfVectorFrame& offset,
                                  bool transmitted) {
  ShiftedDirection result = transmitted ? copy_refraction(base, wi, offset) : copy_reflection(base, wi, offset);
  if (result.failure == ShiftFailure::None && !(result.jacobian > 0.0f && is_finite(result.jacobian))) {
    return failed(ShiftFailure::Jacobian);
  }
  return result;
}

float class_width(const bsdf::Closures& closures, bsdf::ScatterClass c) {
  float width = kInfinity;
  for (int i = 0; i < closures.count(); ++i) {
    const bsdf::Lobe& lobe = closures.lobe(i);
    if (!bsdf::is_dirac(lobe.type) && bsdf::scatters_within(lobe, c)) {
      width = std::min({width, lobe.alpha_x, lobe.alpha_y});
    }
  }
  return width;
}

HalfVectorFrame class_frame(const bsdf::Closures& closures, bsdf::ScatterClass c, const Vec3& wo) {
  for (int i = 0; i < closures.count(); ++i) {
    const bsdf::Lobe& lobe = closures.lobe(i);
    if (!bsdf::is_dirac(lobe.type) && bsdf::scatters_within(lobe, c)) {
      return {wo, lobe.normal, lobe.ior};
    }
  }
  return {wo, Vec3(0, 0, 1), 1.0f};
}

ShiftedEvent copy_event(const path::Vertex& x, const path::ScatterEvent& event, const path::Vertex& y) {
  if (!(y.shade.closures.class_probability(event.scatter_class) > 0.0f)) {
    return failed_event(ShiftFailure::Class);
  }
  if (event.sample.dirac) {
    return copy_dirac_event(event, y);
  }
  if (!y.shade.closures.has_smooth(event.scatter_class)) {
    return failed_event(ShiftFailure::Class);
  }
  const bool transmitted = event.scatter_class == bsdf::ScatterClass::Transmission;
  const ShiftedDirection direction =
      copy_half_vector(class_frame(x.shade.closures, event.scatter_class, x.wo), event.sample.wi,
                       class_frame(y.shade.closures, event.scatter_class, y.wo), transmitted);
  if (direction.failure != ShiftFailure::None) {
    return failed_event(direction.failure);
  }
  if (is_transmission(x, event.sample.wi) != is_transmission(y, direction.wi)) {
    return failed_event(ShiftFailure::Side);
  }
  return event_towards(event, y, direction.wi, direction.jacobian);
}

}  // namespace gradus::gradient
