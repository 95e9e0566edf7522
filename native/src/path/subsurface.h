// Scattering of class Subsurface: light enters an object at one vertex and leaves it at another.
//
// The vertex at which it leaves scatters it diffusely, and is lit. Both vertices together are one event D of the path.
#pragma once

#include "path/scatter.h"

namespace gradus::path {

struct SubsurfaceEvent {
  int lobe = 0;            // index of the lobe at the vertex at which light enters
  float pdf = 0.0f;        // P(class)·P(lobe | class)
  Rgb factor = Rgb(0.0f);  // by which the throughput is multiplied: weight of the walk / pdf
};

// Returns whether the vertex scatters by class Subsurface.
inline bool enters_surface(const Vertex& vertex, const VertexSample& u) {
  const bsdf::Closures& closures = vertex.shade.closures;
  bsdf::ScatterClass chosen;
  return closures.class_probability(bsdf::ScatterClass::Subsurface) > 0.0f &&
         choose_class(closures, u.lobe.x, &chosen) && chosen == bsdf::ScatterClass::Subsurface;
}

// Lets light that enters at a vertex travel below the surface to another point of the same instance. The path has
// scattered `depth` times, and the ray that arrives has the state `ray`. Sets the vertex at which the light leaves,
// with its closures, or returns false if it is lost. Equal arguments give equal results, so that a shift can replay the
// event.
bool scatter_below(const PathContext& context, const Sampler& sampler, int depth, const shading::RayState& ray,
                   const Vertex& entry, SubsurfaceEvent* event, Vertex* exit);

}  // namespace gradus::path
