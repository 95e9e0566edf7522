#include "gradient/class_match.h"

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
  const bool some_x = path::choose_class(x, u, &of_x);
  const bool some_y = path::choose_class(y, u, &of_y);
  return some_x == some_y && (!some_x || (of_x == of_y && same_form(x, y, of_x)));
}

}  // namespace gradus::gradient
