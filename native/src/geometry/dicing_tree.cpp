#include "geometry/dicing_tree.h"

#include <algorithm>
#include <array>

#include "geometry/division_pattern.h"

namespace gradus::geometry {

namespace {

// Barycentric coordinates of the points of a DivisionPattern.
constexpr std::array<std::array<float, 2>, 6> kPoints{{{0, 0}, {1, 0}, {0, 1}, {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f}}};

Vec2 point(uint8_t index) { return {kPoints[index][0], kPoints[index][1]}; }

// Returns the coordinates on the divided triangle of a point of a part.
Vec2 to_whole(const std::array<uint8_t, 3>& part, const Vec2& uv) {
  const Vec2 origin = point(part[0]);
  return origin + (point(part[1]) - origin) * uv.x + (point(part[2]) - origin) * uv.y;
}

// Returns the coordinates on a part of a point of the divided triangle, which may lie outside.
Vec2 to_part(const std::array<uint8_t, 3>& part, const Vec2& uv) {
  const Vec2 origin = point(part[0]), p = point(part[1]) - origin, q = point(part[2]) - origin, r = uv - origin;
  const float area = p.x * q.y - p.y * q.x;
  return Vec2(r.x * q.y - r.y * q.x, p.x * r.y - p.y * r.x) / area;
}

float smallest_weight(const Vec2& uv) { return std::min({uv.x, uv.y, 1.0f - uv.x - uv.y}); }

}  // namespace

TrianglePoint DicingTree::to_base(TrianglePoint at) const {
  uint32_t node = leaves[at.triangle];
  while (nodes[node].parent != UINT32_MAX) {
    const Node& parent = nodes[nodes[node].parent];
    at.uv = to_whole(kDivisionPatterns[parent.pattern].parts[nodes[node].part], at.uv);
    node = nodes[node].parent;
  }
  return {node, at.uv};
}

TrianglePoint DicingTree::from_base(TrianglePoint at) const {
  uint32_t node = at.triangle;
  while (nodes[node].pattern != 0) {
    const DivisionPattern& pattern = kDivisionPatterns[nodes[node].pattern];
    uint32_t best = 0;
    Vec2 uv = to_part(pattern.parts[0], at.uv);
    for (uint32_t i = 1; i < pattern.count; ++i) {
      const Vec2 other = to_part(pattern.parts[i], at.uv);
      if (smallest_weight(other) <= smallest_weight(uv)) continue;
      best = i;
      uv = other;
    }
    at.uv = uv;
    node = nodes[node].first + best;
  }
  return {nodes[node].first, at.uv};
}

}  // namespace gradus::geometry
