// Decoupling: base and offset share no further vertices, although at least one of them continues.
//
// Their common prefix is a pair with ratio r like any other, and the rest of the path does not change r. So each path
// continues separately, the offset like a path of its own pixel. Contributions behind the prefix are paired with 0:
// −C/(1 + r) for the base and r·C'/(1 + r) for the offset. An unpaired contribution would count −C. The inverse shift
// does the same, because the decision depends on the pair alone (docs/method.md, "Shifts and Jacobians"). Paths
// decouple in two cases:
//   - One of the two rays met a surface that scatters, and the other did not.
//   - The classes of the two vertices differ, and the base's random number chooses different ones.
// Rays of the same kind must have found both vertices: from the camera, by copied events, or by replayed events. A
// direction copied at class D does not qualify: if the offset's next event were of class D, its path would have been
// reconnected.
#pragma once

#include "gradient/base_path.h"
#include "gradient/offset_path.h"
#include "path/trace.h"

namespace gradus::gradient {

// A shift copies the scattering class of an event, so both vertices must have that class in the same form. Their
// classes can differ, for example at the edge of a pane of glass, in a roughness texture, or where only one vertex has
// total internal reflection. Then the random number that chooses the class counts as a coordinate of the path, and the
// shift copies this number instead of the class. That is a one-to-one map with Jacobian 1, under which every event of
// either vertex has a partner.

// Returns whether class c has the same form in x and y. It has if both lack the class, or if both have it with the same
// number of Dirac lobes and either both or neither have smooth lobes.
bool same_form(const bsdf::Closures& x, const bsdf::Closures& y, bsdf::ScatterClass c);
// Returns whether every class has the same form in x and y.
bool same_classes(const bsdf::Closures& x, const bsdf::Closures& y);
// Returns whether the random number u in [0, 1) chooses the same class, in the same form, for x and y, or no class for
// either.
bool choose_same_class(const bsdf::Closures& x, const bsdf::Closures& y, float u);

// Return whether a path scatters at the end of its last segment.
bool continues(const BasePath& base);
bool continues(const BasePath& base, const OffsetPath& offset);

// Traces the rest of decoupled offset paths with the random numbers of the base.
class DecoupledTracer {
 public:
  explicit DecoupledTracer(const path::PathContext& context) : tracer_(context, &scratch_, nullptr, &rays_, &nobody_) {}

  // Sets the components to sample, as bits.
  void want(uint32_t components) { tracer_.want(components); }
  // Traces the path on from the offset's vertex. `is_lit` says that light samples at this vertex are complete, so that
  // the path scatters next. The result is valid until the next call.
  const path::PathResult& trace(const BasePath& base, OffsetPath* offset, bool is_lit, film::Counters* counters);

 private:
  path::PathScratch scratch_;
  film::Counters rays_;
  path::NoObserver nobody_;
  path::PathTracer<path::NoObserver> tracer_;
};

}  // namespace gradus::gradient
