// A surface vertex of a path.
#pragma once

#include "geometry/surface.h"
#include "light/light_table.h"
#include "shading/shade.h"

namespace gradus::path {

struct Vertex {
  geometry::SurfacePoint point;
  shading::ShadeResult shade;
  Vec3 wo = Vec3(0.0f);               // unit, towards the previous vertex
  mutable light::LightChoice choice;  // a memo: whoever looks for lights from here leaves it to the next

  // Geometric normal on the side of wo.
  Vec3 facing_normal() const { return facing(point.geometric_normal); }
  // What divides the light samples that are reflected from those that are transmitted (shadow_terminator.h).
  Vec3 light_normal() const {
    return facing(point.shadow_terminator_offset > 0.0f ? point.shading_normal : point.geometric_normal);
  }

 private:
  Vec3 facing(const Vec3& normal) const { return glm::dot(point.geometric_normal, wo) < 0.0f ? -normal : normal; }
};

// What light sampling may know about a vertex.
inline light::Receiver receiver_of(const Vertex& vertex) {
  light::Receiver receiver{vertex.point.position, vertex.light_normal(), false, vertex.point.hit.time, &vertex.choice};
  const bsdf::Closures& closures = vertex.shade.closures;
  for (int i = 0; i < closures.count(); ++i) {
    const bsdf::LobeType type = closures.lobe(i).type;
    receiver.transmits |= type == bsdf::LobeType::Translucent || type == bsdf::LobeType::GgxRefraction ||
                          type == bsdf::LobeType::GgxGlass;
  }
  return receiver;
}

}  // namespace gradus::path
