#include "gradient/shifted_event.h"

namespace gradus::gradient {

void count_failure(ShiftFailure cause, film::Counters* counters) {
  switch (cause) {
    case ShiftFailure::Missed:
      ++counters->fail_missed;
      break;
    case ShiftFailure::Occluded:
      ++counters->fail_occluded;
      break;
    case ShiftFailure::Class:
      ++counters->fail_class;
      break;
    case ShiftFailure::TotalReflection:
      ++counters->fail_total_reflection;
      break;
    case ShiftFailure::Side:
      ++counters->fail_side;
      break;
    case ShiftFailure::Density:
      ++counters->fail_density;
      break;
    case ShiftFailure::Jacobian:
      ++counters->fail_jacobian;
      break;
    case ShiftFailure::None:
      break;
  }
}

ShiftedEvent weigh_event(const path::ScatterEvent& event, const Vec3& wi, const Rgb& value, float pdf, float jacobian) {
  ShiftedEvent shifted;
  if (!(pdf > 0.0f) || is_black(value)) {
    return failed_event(ShiftFailure::Density);
  }
  shifted.wi = wi;
  shifted.pdf = pdf;
  shifted.factor = value / pdf;
  shifted.ratio = jacobian * pdf / event.pdf;
  if (!(shifted.ratio > 0.0f) || !is_finite(shifted.ratio)) {
    return failed_event(ShiftFailure::Jacobian);
  }
  return shifted;
}

ShiftedEvent event_towards(const path::ScatterEvent& event, const path::Vertex& y, const Vec3& wi, float jacobian) {
  const bsdf::Closures& closures = y.shade.closures;
  const float probability = closures.class_probability(event.scatter_class);
  if (!(probability > 0.0f) || !closures.has_smooth(event.scatter_class)) {
    return failed_event(ShiftFailure::Class);
  }
  // The two paths would differ in what they show behind the event.
  if (event.glass_limit >= 0.0f &&
      path::is_clear(event.glass_limit, y, event.scatter_class, wi, is_transmission(y, wi)) != event.is_clear) {
    return failed_event(ShiftFailure::Class);
  }
  const bsdf::KindEval eval = closures.evaluate(event.scatter_class, y.wo, wi, event.sample.diffuse);
  // A kind is a pair (diffuse or not, reflected or transmitted). The direction alone determines the second entry.
  const bool same_side = is_transmission(y, wi) == event.sample.transmitted;
  const float share = same_side && eval.all.pdf > 0.0f ? eval.kind.pdf / eval.all.pdf : 0.0f;
  const float kind_ratio = share / event.kind_share();
  const float pdf = probability * eval.all.pdf;
  if (event.by_kind && !(share > 0.0f)) {
    return failed_event(same_side ? ShiftFailure::Class : ShiftFailure::Side);
  }
  if (event.by_kind) {
    return weigh_event(event, wi, eval.kind.value / share, pdf, jacobian * kind_ratio);
  }
  ShiftedEvent shifted = weigh_event(event, wi, eval.all.value, pdf, jacobian);
  shifted.kind_ratio = kind_ratio;
  return shifted;
}

}  // namespace gradus::gradient
