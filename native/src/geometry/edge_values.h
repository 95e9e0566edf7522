// Values of vertices that follow from the edges of a mesh, with the definitions of Cycles.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace gradus::geometry {

using Edge = std::array<uint32_t, 2>;

// Returns, for each vertex, the vertex that stands for its connected part. The choice depends on the order of the edges
// and is that of a disjoint-set forest with union by rank, whose vertex Cycles hashes for Random Per Island.
std::vector<uint32_t> connected_parts(size_t vertex_count, const std::vector<Edge>& edges);

// Returns the pointiness of each vertex: the angle between its normal and the mean direction of its edges, over pi,
// averaged with those of its neighbours. It is 1/2 on a plane. Vertices at the same place count as one.
std::vector<float> pointiness(const MeshData& mesh, std::vector<Edge> edges);

}  // namespace gradus::geometry
