// A surface vertex of a path.
#pragma once

#include "geometry/surface.h"
#include "light/light_table.h"
#include "shading/shade.h"

namespace gradus::path {

struct Vertex {
  geometry::SurfacePoint point;
  shading::ShadeResult shade;
  Vec3 wo = Vec3(0.0f);  // unit vector towards the previous vertex
  // Cache of the distribution over all lights. The first light sample or density at the vertex computes it.
  mutable light::LightChoice choice;

  // Returns the geometric normal on the side of wo.
  Vec3 facing_normal() const { return facing(point.geometric_normal); }
  // Returns the normal of the plane that separates reflected from transmitted light samples
  // (geometry/shadow_terminator.h).
  Vec3 light_normal() const {
    return facing(point.shadow_terminator_offset > 0.0f ? point.shading_normal : point.geometric_normal);
  }

 private:
  Vec3 facing(const Vec3& normal) const { return glm::dot(point.geometric_normal, wo) < 0.0f ? -normal : normal; }
};

// Returns what light sampling needs to know of a vertex whose closures are complete.
inline light::Receiver receiver_of(const Vertex& vertex) {
  return {vertex.point.position, vertex.light_normal(),  vertex.shade.closures.transmits(),
          vertex.point.hit.time, vertex.point.light_set, &vertex.choice};
}

}  // namespace gradus::path
