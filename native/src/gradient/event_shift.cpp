#include "gradient/event_shift.h"

namespace gradus::gradient {

namespace {

ShiftedEvent failed(ShiftFailure failure) {
  ShiftedEvent event;
  event.failure = failure;
  return event;
}

bool is_transmission(const path::Vertex& vertex, const Vec3& wi) { return glm::dot(vertex.facing_normal(), wi) < 0.0f; }

ShiftedEvent weigh(const path::ScatterEvent& event, const Vec3& wi, const Rgb& value, float pdf, float jacobian) {
  ShiftedEvent shifted;
  if (!(pdf > 0.0f) || is_black(value)) {
    // The sampler at the offset's vertex cannot produce this event, so the inverse shift could not start from it.
    return failed(ShiftFailure::Density);
  }
  shifted.wi = wi;
  shifted.pdf = pdf;
  shifted.factor = value / pdf;
  shifted.ratio = jacobian * pdf / event.pdf;
  if (!(shifted.ratio > 0.0f) || !is_finite(shifted.ratio)) {
    return failed(ShiftFailure::Jacobian);
  }
  return shifted;
}

ShiftedEvent copy_dirac(const path::ScatterEvent& event, const path::Vertex& y) {
  const bsdf::Closures& closures = y.shade.closures;
  const int lobe = bsdf::dirac_lobe(closures, event.scatter_class, event.dirac_rank);
  bsdf::BsdfSample sample;
  if (lobe < 0) {
    return failed(ShiftFailure::Class);
  }
  if (!closures.evaluate_dirac(lobe, y.wo, event.sample.transmitted, &sample)) {
    return failed(event.sample.transmitted ? ShiftFailure::TotalReflection : ShiftFailure::Class);
  }
  return weigh(event, sample.wi, sample.value, closures.class_probability(event.scatter_class) * sample.pdf, 1.0f);
}

// Compares the two samples. The side and the kind of a bounce (diffuse or not) are part of the path, so they must
// agree.
ShiftFailure compare(const bsdf::BsdfSample& x, const bsdf::BsdfSample& y) {
  if (x.dirac != y.dirac || x.diffuse != y.diffuse) {
    return ShiftFailure::Class;
  }
  return x.transmitted != y.transmitted ? ShiftFailure::Side : ShiftFailure::None;
}

}  // namespace

ShiftedEvent event_towards(const path::ScatterEvent& event, const path::Vertex& y, const Vec3& wi, float jacobian) {
  const bsdf::Closures& closures = y.shade.closures;
  const float probability = closures.class_probability(event.scatter_class);
  if (!(probability > 0.0f) || !closures.has_smooth(event.scatter_class)) {
    return failed(ShiftFailure::Class);
  }
  const bsdf::KindEval eval = closures.evaluate(event.scatter_class, y.wo, wi, event.sample.diffuse);
  // A kind is a pair (diffuse or not, reflected or transmitted). The direction alone determines the second entry.
  const bool same_side = is_transmission(y, wi) == event.sample.transmitted;
  const float share = same_side && eval.all.pdf > 0.0f ? eval.kind.pdf / eval.all.pdf : 0.0f;
  const float kind_ratio = share / event.kind_share();
  const float pdf = probability * eval.all.pdf;
  if (event.by_kind && !(share > 0.0f)) {
    return failed(same_side ? ShiftFailure::Class : ShiftFailure::Side);
  }
  if (event.by_kind) {
    return weigh(event, wi, eval.kind.value / share, pdf, jacobian * kind_ratio);
  }
  ShiftedEvent shifted = weigh(event, wi, eval.all.value, pdf, jacobian);
  shifted.kind_ratio = kind_ratio;
  return shifted;
}

ShiftedEvent copy_event(const path::Vertex& x, const path::ScatterEvent& event, const path::Vertex& y) {
  if (!(y.shade.closures.class_probability(event.scatter_class) > 0.0f)) {
    return failed(ShiftFailure::Class);
  }
  if (event.sample.dirac) {
    return copy_dirac(event, y);
  }
  if (!y.shade.closures.has_smooth(event.scatter_class)) {
    return failed(ShiftFailure::Class);
  }
  const bool transmitted = event.scatter_class == bsdf::ScatterClass::Transmission;
  const ShiftedDirection direction =
      copy_half_vector(class_frame(x.shade.closures, event.scatter_class, x.wo), event.sample.wi,
                       class_frame(y.shade.closures, event.scatter_class, y.wo), transmitted);
  if (direction.failure != ShiftFailure::None) {
    return failed(direction.failure);
  }
  if (is_transmission(x, event.sample.wi) != is_transmission(y, direction.wi)) {
    return failed(ShiftFailure::Side);
  }
  return event_towards(event, y, direction.wi, direction.jacobian);
}

ShiftedEvent replay_event(const path::Vertex& x, const path::ScatterEvent& event, const path::VertexSample& u,
                          const path::Vertex& y) {
  const bsdf::ScatterClass c = event.scatter_class;
  const float probability = y.shade.closures.class_probability(c);
  bsdf::BsdfSample sample;
  if (!(probability > 0.0f)) {
    return failed(ShiftFailure::Class);
  }
  if (!y.shade.closures.sample(c, y.wo, u.lobe.y, u.bsdf, &sample)) {
    return failed(ShiftFailure::Density);
  }
  const ShiftFailure failure = compare(event.sample, sample);
  if (failure != ShiftFailure::None) {
    return failed(failure);
  }
  const bsdf::BsdfEval of_kind = event.by_kind ? sample.kind : bsdf::BsdfEval{sample.value, sample.pdf};
  ShiftedEvent shifted = weigh(event, sample.wi, of_kind.value, probability * of_kind.pdf, 1.0f);
  shifted.pdf = probability * sample.pdf;
  shifted.ratio = probability / x.shade.closures.class_probability(c);
  return shifted;
}

}  // namespace gradus::gradient
