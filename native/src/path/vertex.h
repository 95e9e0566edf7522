// A surface vertex of a path.
#pragma once

#include "scene/emitter_table.h"
#include "scene/surface.h"
#include "shading/shade.h"

namespace gradus {

struct Vertex {
  SurfacePoint point;
  ShadeResult shade;
  Vec3 wo = Vec3(0.0f);          // unit, towards the previous vertex
  mutable EmitterChoice choice;  // a memo: whoever looks for lights from here leaves it to the next

  // Geometric normal on the side of wo.
  Vec3 facing_normal() const { return glm::dot(point.geometric_normal, wo) < 0.0f ? -point.geometric_normal : point.geometric_normal; }
};

// What light sampling may know about a vertex.
inline Receiver receiver_of(const Vertex& vertex) {
  Receiver receiver{vertex.point.position, vertex.facing_normal(), false, &vertex.choice};
  const Closures& closures = vertex.shade.closures;
  for (int i = 0; i < closures.count(); ++i) {
    const LobeType type = closures.lobe(i).type;
    receiver.transmits |= type == LobeType::Translucent || type == LobeType::GgxRefraction || type == LobeType::GgxGlass;
  }
  return receiver;
}

}  // namespace gradus
