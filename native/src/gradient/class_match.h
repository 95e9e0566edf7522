// Whether two vertices scatter by the same classes.
//
// A shift copies the class of an event. That needs both vertices to have it, in the same form. Where their classes
// differ (the edge of a pane of glass, a texture of roughness, total reflection on one side) the random number that
// chose the class counts as part of the path and is copied in its place: a one-to-one map with Jacobian 1, under which
// every event of either vertex has a partner.
#pragma once

#include "path/scatter.h"

namespace gradus::gradient {

// Both lack the class, or have it with the same number of Dirac lobes, and smooth ones both or neither.
bool same_form(const bsdf::Closures& x, const bsdf::Closures& y, bsdf::ScatterClass c);
// All classes have the same form.
bool same_classes(const bsdf::Closures& x, const bsdf::Closures& y);
// The random number u takes both to one class of the same form, or to none.
bool choose_same_class(const bsdf::Closures& x, const bsdf::Closures& y, float u);

}  // namespace gradus::gradient
