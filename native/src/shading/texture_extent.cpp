#include "shading/texture_extent.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/surface_values.h"
#include "shading/context.h"
#include "shading/graph.h"

namespace gradus::shading {
namespace {

// Extents in pixels.
constexpr float kSeenByCamera = 0.5f;
constexpr float kBehindDiffuse = 8.0f;

// Smallest length of a unit vector on the side of a box onto which it is projected: 1/√3.
constexpr float kShortestOnBox = 0.577f;

// ---- The map of coordinates ----

// Returns the smallest factor by which a scale shortens a vector. UV maps lie in the plane of x and y.
float shortening(const Vec3& scale, bool is_planar) {
  const Vec3 s = glm::abs(scale);
  return is_planar ? std::min(s.x, s.y) : std::min({s.x, s.y, s.z});
}

bool is_uv(const TextureMap& map) { return map.source == TextureMap::Source::UvMap; }

// Returns whether a rotation keeps the axes that projections drop.
bool keeps_axes(const GraphValue& rotation, bool is_planar) {
  const Vec4& r = rotation.constant;
  return rotation.is_constant() && r.x == 0.0f && r.y == 0.0f && (is_planar || r.z == 0.0f);
}

TextureMap scaled(TextureMap map, float factor) {
  map.scale *= factor;
  return map;
}

TextureMap map_of_mapping(const Graph& graph, const GraphNode& n) {
  if (!n.inputs[3].is_constant() || n.mode == GRADUS_MAPPING_NORMAL) return {};
  const TextureMap map = texture_map(graph, n.inputs[0]);
  if (!keeps_axes(n.inputs[2], is_uv(map))) return {};
  const Vec3 scale(n.inputs[3].constant);
  if (n.mode != GRADUS_MAPPING_TEXTURE) return scaled(map, shortening(scale, is_uv(map)));
  const Vec3 inverse = 1.0f / glm::abs(scale);
  return scaled(map, is_finite(inverse.x + inverse.y + inverse.z) ? shortening(inverse, is_uv(map)) : 0.0f);
}

TextureMap map_of_vector_math(const Graph& graph, const GraphNode& n) {
  const GraphValue &a = n.inputs[0], &b = n.inputs[1];
  if (n.mode == GRADUS_VECTOR_SCALE)
    return n.inputs[3].is_constant() ? scaled(texture_map(graph, a), std::fabs(n.inputs[3].constant.x)) : TextureMap();
  const bool adds = n.mode == GRADUS_VECTOR_ADD || n.mode == GRADUS_VECTOR_SUBTRACT;
  if (a.is_constant() == b.is_constant() || !(adds || n.mode == GRADUS_VECTOR_MULTIPLY)) return {};
  const TextureMap map = texture_map(graph, a.is_constant() ? b : a);
  const Vec3 factor(a.is_constant() ? a.constant : b.constant);
  return adds ? map : scaled(map, shortening(factor, is_uv(map)));
}

TextureMap map_of_coordinates(const Graph& graph, const GraphNode& n) {
  switch (n.mode) {
    case GRADUS_TEX_COORD_UV:
      return {TextureMap::Source::UvMap, n.resource > 0 ? graph.names[n.resource - 1] : "", 1.0f};
    case GRADUS_TEX_COORD_GENERATED:
      return {TextureMap::Source::Generated, "", kShortestOnBox};
    case GRADUS_TEX_COORD_OBJECT:
      return {n.float_count == 0 ? TextureMap::Source::Object : TextureMap::Source::Unknown, "", kShortestOnBox};
    default:
      return {};
  }
}

// ---- Its value at a point ----

using Corners = std::array<Vec3, 3>;

// Finds the coordinates at the corners of the triangle that is hit. Returns false if the mesh does not have them.
bool source_corners(const TextureMap& map, const ShadeContext& c, Corners* corners) {
  const geometry::MeshData& mesh = *c.instance->mesh;
  switch (map.source) {
    case TextureMap::Source::UvMap: {
      const geometry::MeshAttribute* uv = geometry::uv_map(mesh, map.uv_map);
      if (!uv) return false;
      const std::array<Vec4, 3> values = geometry::corner_values(mesh, *uv, c.hit.primitive);
      for (size_t k = 0; k < 3; ++k) (*corners)[k] = Vec3(Vec2(values[k]), 0.0f);
      return true;
    }
    case TextureMap::Source::Generated:
      *corners = {geometry::generated_at(mesh, c.hit.primitive, Vec2(0.0f)),
                  geometry::generated_at(mesh, c.hit.primitive, Vec2(1.0f, 0.0f)),
                  geometry::generated_at(mesh, c.hit.primitive, Vec2(0.0f, 1.0f))};
      return true;
    case TextureMap::Source::Object:
      *corners = geometry::triangle_positions_in_shutter(mesh, c.hit.primitive, c.hit.time);
      return true;
    default:
      return false;
  }
}

// The lengths and the angle of two edges of a triangle.
struct Metric {
  float aa, ab, bb;
  explicit Metric(const Corners& p) {
    const Vec3 a = p[1] - p[0], b = p[2] - p[0];
    aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b);
  }
  float determinant() const { return aa * bb - ab * ab; }
};

// Returns the smaller factor by which the linear map from one triangle to the other stretches lengths: the root of the
// smaller eigenvalue of G⁻¹H for their metrics G and H.
float smaller_stretch(const Corners& from, const Corners& to) {
  const Metric g(from), h(to);
  const float area = g.determinant();
  if (!(area > 0.0f)) return 0.0f;
  const float half_trace = 0.5f * (g.bb * h.aa - 2.0f * g.ab * h.ab + g.aa * h.bb) / area;
  const float product = std::max(h.determinant(), 0.0f) / area;
  const float larger = half_trace + std::sqrt(std::max(half_trace * half_trace - product, 0.0f));
  return larger > 0.0f ? std::sqrt(product / larger) : 0.0f;
}

// Returns the extent in pixels. Behind a portal the distance from the camera says nothing.
float pixels_averaged(const RayState& ray) {
  if (ray.portal_depth > 0) return 0.0f;
  if (ray.flags & kRayCamera) return kSeenByCamera;
  return ray.flags & kRayDiffuseAncestor ? kBehindDiffuse : 0.0f;
}

}  // namespace

TextureMap texture_map(const Graph& graph, const GraphValue& vector) {
  if (vector.is_constant()) return {};
  const GraphNode& n = graph.nodes[static_cast<size_t>(vector.node)];
  switch (n.op) {
    case GRADUS_OP_TEX_COORD:
      return map_of_coordinates(graph, n);
    case GRADUS_OP_MAPPING:
      return map_of_mapping(graph, n);
    case GRADUS_OP_VECTOR_MATH:
      return map_of_vector_math(graph, n);
    default:
      return {};
  }
}

float texture_extent(const TextureMap& map, const ShadeContext& c) {
  const float pixels = pixels_averaged(c.ray) * c.ray.pixel_angle;
  Corners coordinates;
  if (!(pixels > 0.0f) || !c.instance || !source_corners(map, c, &coordinates)) return 0.0f;
  const Corners positions = geometry::corners(*c.instance, c.hit.primitive, c.hit.time);
  return pixels * camera_distance(c) * smaller_stretch(positions, coordinates) * map.scale;
}

}  // namespace gradus::shading
