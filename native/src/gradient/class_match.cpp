#include "gradient/class_match.h"

namespace gradus {

bool same_form(const Closures& x, const Closures& y, ScatterClass c) {
  const bool present = x.class_probability(c) > 0.0f;
  if (present != (y.class_probability(c) > 0.0f)) {
    return false;
  }
  return !present || (x.has_smooth(c) == y.has_smooth(c) && x.dirac_count(c) == y.dirac_count(c));
}

bool same_classes(const Closures& x, const Closures& y) {
  for (int c = 0; c < kScatterClasses; ++c) {
    if (!same_form(x, y, static_cast<ScatterClass>(c))) {
      return false;
    }
  }
  return true;
}

bool choose_same_class(const Closures& x, const Closures& y, float u) {
  ScatterClass of_x = ScatterClass::Diffuse, of_y = ScatterClass::Diffuse;
  const bool some_x = choose_class(x, u, &of_x);
  const bool some_y = choose_class(y, u, &of_y);
  return some_x == some_y && (!some_x || (of_x == of_y && same_form(x, y, of_x)));
}

}  // namespace gradus
