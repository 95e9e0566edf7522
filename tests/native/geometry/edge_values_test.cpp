#include "geometry/edge_values.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "base/clock.h"
#include "base/error.h"
#include "geometry/weld.h"
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

// Returns weld() by its definition: each vertex and the first one at its place that has a larger sum of coordinates.
std::vector<uint32_t> weld_by_definition(const std::vector<Vec3>& p) {
  std::vector<uint32_t> order(p.size()), welded(p.size());
  std::iota(order.begin(), order.end(), 0u);
  std::iota(welded.begin(), welded.end(), 0u);
  const auto sum = [&](uint32_t v) { return p[v].x + p[v].y + p[v].z; };
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return sum(a) != sum(b) ? sum(a) < sum(b) : a > b; });
  for (size_t i = order.size(); i-- > 0;) {
    for (size_t k = i + 1; k < order.size() && sum(order[k]) - sum(order[i]) <= 3.0f * FLT_EPSILON; ++k) {
      const Vec3 step = p[order[k]] - p[order[i]];
      if (!(glm::dot(step, step) < FLT_EPSILON)) continue;
      welded[order[i]] = welded[order[k]];
      break;
    }
  }
  return welded;
}

// Vertices by chance, some at one place and some just beyond the tolerance, in a plane of equal sums or in space.
TEST(EdgeValues, WeldsAsItsDefinitionSays) {
  std::mt19937 random(7);
  for (const bool is_plane : {true, false})
    for (const float size : {3e-4f, 3e-3f, 1.0f}) {
      std::vector<Vec3> p;
      std::uniform_real_distribution<float> place(-size, size), near(-3e-4f, 3e-4f);
      for (int i = 0; i < 700; ++i) {
        const float x = place(random), y = place(random);
        p.emplace_back(x, y, is_plane ? -x - y : place(random));
        const float dx = near(random), dy = near(random);
        p.push_back(p.back() + Vec3(dx, dy, -dx - dy));
        if (i % 3 == 0) p.push_back(p[size_t(i)]);
      }
      EXPECT_EQ(geometry::weld(p.data(), p.size()), weld_by_definition(p)) << is_plane << size;
    }
}

// Regression: all vertices of a plane across x + y + z were compared with each other, which took minutes for a million.
TEST(EdgeValues, WeldsALargePlane) {
  std::vector<Vec3> p;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x) p.emplace_back(float(x), float(y), -float(x) - float(y));
  const uint64_t begin = thread_cpu_nanoseconds();
  const std::vector<uint32_t> welded = geometry::weld(p.data(), p.size());
  EXPECT_LT(1e-9 * double(thread_cpu_nanoseconds() - begin), 1.0);
  for (uint32_t i = 0; i < p.size(); ++i) EXPECT_EQ(welded[i], i);
  p[5] = Vec3(std::numeric_limits<float>::quiet_NaN());
  p[6] = Vec3(kInfinity);
  EXPECT_EQ(geometry::weld(p.data(), p.size())[5], 5u);
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
