// How the triangles of a diced mesh descend from those of the mesh before.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::geometry {

// A point of a triangle, by the weights of its second and third corner.
struct TrianglePoint {
  uint32_t triangle = 0;
  Vec2 uv{0.0f};
};

// Two diced meshes of one mesh divide the same surface at other places. The tree leads from a point of one to the same
// point of the other, which keeps the correspondence between frames while a camera moves.
struct DicingTree {
  struct Node {
    uint32_t parent = UINT32_MAX;  // UINT32_MAX: a triangle of the mesh, in order
    uint32_t first = 0;            // the first of its parts, which follow each other; the diced triangle of a leaf
    uint8_t pattern = 0;           // number of its DivisionPattern; 0: a leaf
    uint8_t part = 0;              // which part of its parent it is
  };

  std::vector<Node> nodes;
  std::vector<uint32_t> leaves;  // node of each diced triangle
  uint64_t topology_hash = 0;    // of the mesh before

  // Returns the point of the mesh before at a point of the diced mesh.
  TrianglePoint to_base(TrianglePoint point) const;
  // Returns the point of the diced mesh at a point of the mesh before.
  TrianglePoint from_base(TrianglePoint point) const;
};

}  // namespace gradus::geometry
