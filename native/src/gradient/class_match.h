// Compares the scattering classes of two vertices.
//
// A shift copies the scattering class of an event, so both vertices must have that class in the same form. Their
// classes can differ, for example at the edge of a pane of glass, in a roughness texture, or where only one vertex has
// total internal reflection. Then the random number that chooses the class counts as a coordinate of the path, and the
// shift copies this number instead of the class. That is a one-to-one map with Jacobian 1, under which every event of
// either vertex has a partner.
//
// A shift copies the class of an event. That needs both vertices to have it, in the same form. Where their classes
// differ (the edge of a pane of glass, a texture of roughness, total reflection on one side) the random number that
// chose the class counts as part of the path and is copied in its place: a one-to-one map with Jacobian 1, under which
// every event of either vertex has a partner.
#pragma once

#include "path/scatter.h"

namespace gradus::gradient {

// Returns whether class c has the same form in x and y. It has if both lack the class, or if both have it with the same
// number of Dirac lobes and either both or neither have smooth lobes.
bool same_form(const bsdf::Closures& x, const bsdf::Closures& y, bsdf::ScatterClass c);
// Returns whether every class has the same form in x and y.
bool same_classes(const bsdf::Closures& x, const bsdf::Closures& y);
// Returns whether the random number u in [0, 1) chooses the same class, in the same form, for x and y, or no class for
// either.
bool choose_same_class(const bsdf::Closures& x, const bsdf::Closures& y, float u);

}  // namespace gradus::gradient
