#include "gradient/decoupling.h"

namespace gradus::gradient {

bool same_form(const bsdf::Closures& x, const bsdf::Closures& y, bsdf::ScatterClass c) {
  const bool present = x.class_probability(c) > 0.0f;
  if (present != (y.class_probability(c) > 0.0f)) {
    return false;
  }
  return !present || (x.has_smooth(c) == y.has_smooth(c) && x.dirac_count(c) == y.dirac_count(c));
}

bool same_classes(const bsdf::Closures& x, const bsdf::Closures& y) {
  for (int c = 0; c < bsdf::kScatterClasses; ++c) {
    if (!same_form(x, y, static_cast<bsdf::ScatterClass>(c))) {
      return false;
    }
  }
  return true;
}

bool choose_same_class(const bsdf::Closures& x, const bsdf::Closures& y, float u) {
  bsdf::ScatterClass of_x = bsdf::ScatterClass::Diffuse, of_y = bsdf::ScatterClass::Diffuse;
  const bool has_x = path::choose_class(x, u, &of_x);
  const bool has_y = path::choose_class(y, u, &of_y);
  return has_x == has_y && (!has_x || (of_x == of_y && same_form(x, y, of_x)));
}

bool continues(const BasePath& base) {
  return base.segment->end == path::SegmentEnd::Surface && !base.state.emission_only &&
         !path::is_at_transparent_limit(base.context, base.state.ray.state) && !base.ends_in_hole;
}

bool continues(const BasePath& base, const OffsetPath& offset) {
  return offset.segment->end == path::SegmentEnd::Surface && !base.state.emission_only &&
         !path::is_at_transparent_limit(base.context, offset.state.ray.state) &&
         !(offset.state.shows_background() && path::cuts_hole(base.context, *offset.vertex));
}

const path::PathResult& DecoupledTracer::trace(const BasePath& base, OffsetPath* offset, bool is_lit,
                                               film::Counters* counters) {
  rays_ = film::Counters{};
  const path::PathResult& result = tracer_.continue_path(*base.sampler, offset->state, offset->vertex, is_lit);
  counters->rays_shift += rays_.rays_bounce;
  counters->rays_shift_shadow += rays_.rays_shadow;
  return result;
}

}  // namespace gradus::gradient
