#include "geometry/edge_values.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "scene/scene_fixture.h"

namespace gradus::test::edge_values_test {
namespace {

using geometry::Edge;

// Returns a mesh of triangles with the edges of all of them.
std::shared_ptr<const geometry::MeshData> mesh_of(const Soup& soup) {
  MeshDesc mesh(soup);
  std::vector<int32_t> edges;
  for (size_t i = 0; i < soup.vertices.size(); ++i)
    edges.insert(edges.end(), {soup.vertices[i], soup.vertices[i % 3 == 2 ? i - 2 : i + 1]});
  mesh.desc.edge_count = edges.size() / 2;
  mesh.desc.edge_vertices = edges.data();
  return geometry::make_mesh(mesh.desc);
}

// A vertex in the middle of six others at a distance of 1, which lie lower by `depth`.
Soup cone(float depth) {
  Soup soup;
  soup.positions.emplace_back(0.0f);
  for (int i = 0; i < 6; ++i) {
    const float phi = float(i) * kPi / 3.0f;
    soup.positions.emplace_back(std::cos(phi), std::sin(phi), -depth);
    soup.vertices.insert(soup.vertices.end(), {0, 1 + i, 1 + (i + 1) % 6});
  }
  return soup;
}

TEST(EdgeValues, UnionByRankChoosesTheRepresentative) {
  const std::vector<Edge> edges{{1, 2}, {0, 1}, {3, 4}, {4, 3}};
  EXPECT_EQ(geometry::connected_parts(6, edges), (std::vector<uint32_t>{1, 1, 1, 3, 3, 5}));
}

TEST(EdgeValues, AFlatMeshHasAPointinessOfOneHalf) {
  const auto mesh = mesh_of(cone(0.0f));
  // All edges lie in the plane, so that their angle to the normal is a right one.
  for (const float value : mesh->pointiness) EXPECT_NEAR(value, 0.5f, 1e-6f);
}

// Turned upside down, a mesh has the supplements of its angles.
TEST(EdgeValues, ATipIsMorePointedThanAPit) {
  const auto tip = mesh_of(cone(0.5f)), pit = mesh_of(cone(-0.5f));
  EXPECT_GT(tip->pointiness[0], 0.5f);
  EXPECT_NEAR(tip->pointiness[0] + pit->pointiness[0], 1.0f, 1e-5f);
}

// Regression: vertices at one place count as one, as where a mesh is split.
TEST(EdgeValues, SplitVerticesAreWelded) {
  const Soup whole = cone(0.4f);
  Soup split;
  for (size_t i = 0; i < whole.vertices.size(); i += 3)
    split.triangle(whole.positions[size_t(whole.vertices[i])], whole.positions[size_t(whole.vertices[i + 1])],
                   whole.positions[size_t(whole.vertices[i + 2])]);
  const auto a = mesh_of(whole), b = mesh_of(split);
  for (size_t i = 0; i < whole.vertices.size(); ++i)
    EXPECT_NEAR(b->pointiness[i], a->pointiness[size_t(whole.vertices[i])], 1e-5f) << i;
  EXPECT_EQ(a->islands, std::vector<uint32_t>(7, a->islands[0]));
  EXPECT_NE(b->islands[0], b->islands[3]);
}

TEST(EdgeValues, AVertexBeyondTheMeshIsAnError) {
  MeshDesc mesh(cone(0.0f));
  const int32_t edge[] = {0, 7};
  mesh.desc.edge_count = 1;
  mesh.desc.edge_vertices = edge;
  EXPECT_THROW(geometry::make_mesh(mesh.desc), Error);
}

}  // namespace
}  // namespace gradus::test::edge_values_test
