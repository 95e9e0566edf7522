// A triangle that is curved along the smooth normals of its corners. Source: Vlachos, Peters, Boyd and Mitchell, Curved
// PN Triangles (2001).
#pragma once

#include <array>

#include "geometry/plane.h"

namespace gradus::geometry {

// The corners and normals of a triangle. Edges that are not smooth stay straight, because triangles on their two sides
// have different normals. Two patches with a common edge agree along it.
struct CurvedPatch {
  std::array<Vec3, 3> positions, normals;
  std::array<bool, 3> is_smooth;  // of the edge from each corner to the next

  // Returns by how much the curved surface is beside the flat triangle at barycentric coordinates `uv`.
  Vec3 bend(const Vec2& uv) const {
    const std::array<float, 3> w = weights(uv);
    Vec3 on_edges(0.0f), sum(0.0f);
    for (size_t i = 0; i < 3; ++i) {
      const size_t j = (i + 1) % 3;
      if (!is_smooth[i]) continue;
      const Vec3 along = positions[j] - positions[i];
      const Vec3 near_i = normals[i] * -glm::dot(along, normals[i]), near_j = normals[j] * glm::dot(along, normals[j]);
      on_edges += (near_i * w[i] + near_j * w[j]) * (w[i] * w[j]);
      sum += near_i + near_j;
    }
    return on_edges + sum * (0.5f * w[0] * w[1] * w[2]);
  }

  // Returns the unit normal at `uv`, which changes quadratically.
  Vec3 normal(const Vec2& uv) const {
    const std::array<float, 3> w = weights(uv);
    Vec3 result(0.0f);
    for (size_t i = 0; i < 3; ++i) {
      const size_t j = (i + 1) % 3;
      result += normals[i] * (w[i] * w[i]);
      if (w[i] * w[j] > 0.0f) result += middle(i, j) * (2.0f * w[i] * w[j]);
    }
    return safe_unit(result, normals[0]);
  }

 private:
  static std::array<float, 3> weights(const Vec2& uv) { return {1.0f - uv.x - uv.y, uv.x, uv.y}; }

  // Returns the middle control normal of an edge: the mean of its ends, mirrored in the plane across the edge.
  Vec3 middle(size_t i, size_t j) const {
    const Vec3 along = positions[j] - positions[i], sum = normals[i] + normals[j];
    const float square = glm::dot(along, along);
    const Vec3 mirrored = square > 0.0f ? sum - along * (2.0f * glm::dot(along, sum) / square) : sum;
    return safe_unit(mirrored, sum * 0.5f);
  }
};

}  // namespace gradus::geometry
