// Values on meshes: attributes by domain, normals, generated coordinates, materials by face, motion.
#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include "scene/scene_fixture.h"

namespace gradus::test::mesh_test {
namespace {

// A quad of two triangles over four vertices, one face, in the layout of Blender.
struct Quad {
  std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  std::vector<int32_t> corner_vertices = {0, 1, 2, 3};
  std::vector<uint32_t> triangle_corners = {0, 1, 2, 0, 2, 3};
  std::vector<int32_t> triangle_faces = {0, 0};
  std::vector<int32_t> face_materials = {0};
  GradusMesh desc{};

  GradusMesh& make() {
    desc.struct_size = sizeof(desc);
    desc.key_count = std::max(1u, desc.key_count);
    desc.vertex_count = 4;
    desc.positions = positions.data();
    desc.corner_count = 4;
    desc.corner_vertices = corner_vertices.data();
    desc.triangle_count = 2;
    desc.triangle_corners = triangle_corners.data();
    desc.triangle_faces = triangle_faces.data();
    desc.face_count = 1;
    desc.face_materials = face_materials.data();
    desc.normal_domain = desc.normals ? desc.normal_domain : uint32_t(GRADUS_DOMAIN_FACE);
    for (float& s : desc.generated_size) s = s == 0.0f ? 1.0f : s;
    desc.name = "quad";
    return desc;
  }
};

GradusAttribute make_attribute(const char* name, GradusDomain domain, uint32_t channels, const float* data,
                               bool is_uv = false) {
  return {sizeof(GradusAttribute), uint32_t(domain), channels, is_uv ? 1u : 0u, name, data};
}

TEST(Mesh, AttributesOfAllDomains) {
  const float points[4] = {0, 1, 2, 3}, faces[3] = {4, 5, 6}, corners[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  const GradusAttribute attributes[3] = {make_attribute("p", GRADUS_DOMAIN_POINT, 1, points),
                                         make_attribute("f", GRADUS_DOMAIN_FACE, 3, faces),
                                         make_attribute("uv", GRADUS_DOMAIN_CORNER, 2, corners, true)};
  Quad quad;
  quad.desc.attributes = attributes;
  quad.desc.attribute_count = 3;
  const auto mesh = geometry::make_mesh(quad.make());
  const auto value = [&](const char* name, uint32_t triangle) {
    return geometry::corner_values(*mesh, *geometry::find_attribute(*mesh, name), triangle);
  };
  EXPECT_EQ(geometry::interpolate(value("p", 1), Vec2(0.5f, 0.25f)).x, 0.5f * 2 + 0.25f * 3);
  EXPECT_EQ(value("f", 0)[2], Vec4(4, 5, 6, 1));
  EXPECT_EQ(value("uv", 1)[1], Vec4(1, 1, 0, 1));
  EXPECT_EQ(geometry::default_uv_map(*mesh), geometry::find_attribute(*mesh, "uv"));
  EXPECT_EQ(geometry::find_attribute(*mesh, "no"), nullptr);
}

TEST(Mesh, DefaultUvMapIsTheNamedOne) {
  const float uv[8] = {};
  const GradusAttribute attributes[3] = {make_attribute("a", GRADUS_DOMAIN_CORNER, 2, uv, true),
                                         make_attribute("b", GRADUS_DOMAIN_CORNER, 2, uv, true),
                                         make_attribute("c", GRADUS_DOMAIN_CORNER, 2, uv, true)};
  Quad quad;
  quad.desc.attributes = attributes;
  quad.desc.attribute_count = 3;
  EXPECT_EQ(geometry::default_uv_map(*geometry::make_mesh(quad.make()))->name, "a");
  quad.desc.default_uv = "b";
  EXPECT_EQ(geometry::default_uv_map(*geometry::make_mesh(quad.make()))->name, "b");
}

TEST(Mesh, GeneratedCoordinatesFillTheTextureSpace) {
  Quad quad;
  for (int i = 0; i < 3; ++i) quad.desc.generated_location[i] = 0.5f, quad.desc.generated_size[i] = 0.5f;
  EXPECT_EQ(geometry::generated_at(*geometry::make_mesh(quad.make()), 0, Vec2(0, 1)), Vec3(1, 1, 0));
  const float rest[12] = {0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 1, 0};
  quad.desc.generated_points = rest;
  EXPECT_EQ(geometry::generated_at(*geometry::make_mesh(quad.make()), 0, Vec2(0, 1)), Vec3(1, 1, 1));
}

std::shared_ptr<const scene::Snapshot> commit_quad(scene::Scene* scene, const GradusMesh& mesh, const Mat4& matrix,
                                                   const Mat4& previous, const Mat4& next) {
  scene->set_mesh(1, mesh);
  const uint64_t key = 1;
  GradusInstances instances{};
  instances.struct_size = sizeof(instances);
  instances.count = 1;
  instances.meshes = &key;
  instances.matrices = &matrix[0][0];
  instances.matrices_previous = &previous[0][0];
  instances.matrices_next = &next[0][0];
  scene->set_instances(instances);
  scene->commit(nullptr, nullptr);
  return scene->snapshot();
}

geometry::Hit hit_at(const Vec2& barycentric) {
  geometry::Hit hit;
  hit.instance = 0;
  hit.primitive = 0;
  hit.uv = barycentric;
  return hit;
}

// C1 for surfaces: deformation by keys and motion by matrices, together.
TEST(C1_SurfaceMotion, DeformationAndMatrices) {
  Quad quad;
  const std::vector<float> rest = quad.positions;
  quad.positions.clear();
  for (const float key : {-1.0f, 0.0f, 1.0f})
    for (size_t i = 0; i < rest.size(); ++i)
      quad.positions.push_back(rest[i] + (i % 3 == 2 ? 0.5f * key * rest[i - 2] : 0.0f));
  const float times[3] = {-1, 0, 1};
  quad.desc.key_count = 3;
  quad.desc.key_times = times;
  scene::Scene scene(test_device());
  const auto snapshot = commit_quad(&scene, quad.make(), Mat4(1.0f), translation(Vec3(-0.1f, 0, 0)),
                                    translation(Vec3(0.2f, 0, 0)) * scaling(Vec3(2, 1, 1)));
  const geometry::Hit hit = hit_at(Vec2(0.25f, 0.5f));  // at (0.75, 0.5)
  const Vec3 now = snapshot->surface_point(hit).position;
  const Vec3 before = snapshot->position_at(hit, Moment::Previous), after = snapshot->position_at(hit, Moment::Next);
  EXPECT_LT(glm::length(now - Vec3(0.75f, 0.5f, 0)), 1e-6f);
  EXPECT_LT(glm::length(before - Vec3(0.65f, 0.5f, -0.375f)), 1e-6f);
  EXPECT_LT(glm::length(after - Vec3(1.7f, 0.5f, 0.375f)), 1e-6f);
}

TEST(C1_SurfaceMotion, AStaticPointHasExactlyTheSamePosition) {
  Quad quad;
  scene::Scene scene(test_device());
  const Mat4 matrix = translation(Vec3(0.1f, 0.7f, -0.3f)) * scaling(Vec3(1.3f, 0.9f, 1.0f));
  const auto snapshot = commit_quad(&scene, quad.make(), matrix, matrix, matrix);
  for (int i = 0; i < 100; ++i) {
    const geometry::Hit hit = hit_at(Vec2(0.37f, 0.005f * float(i)));
    EXPECT_EQ(snapshot->position_at(hit, Moment::Previous), snapshot->position_at(hit, Moment::Next));
    EXPECT_EQ(snapshot->position_at(hit, Moment::Next), snapshot->surface_point(hit).position);
  }
}

TEST(SurfacePoint, NormalsByCornerAreInterpolatedAndInvalidOnesReplaced) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float smooth[12] = {0, -1, 1, 0, -1, 1, 0, 1, 1, 0, 1, 1},
              broken[12] = {nan, 0, 1, 0, 0, 0, 0, nan, nan, 0, 0, 0};
  Quad quad;
  quad.desc.normal_domain = GRADUS_DOMAIN_CORNER;
  scene::Scene scene(test_device());
  quad.desc.normals = smooth;
  auto snapshot = commit_quad(&scene, quad.make(), Mat4(1.0f), Mat4(1.0f), Mat4(1.0f));
  const Vec3 n = snapshot->surface_point(hit_at(Vec2(0.25f, 0.5f))).shading_normal;
  EXPECT_LT(glm::length(n - Vec3(0, 0, 1)), 1e-6f);
  EXPECT_GT(snapshot->surface_point(hit_at(Vec2(0, 0.9f))).shading_normal.y, 0.5f);
  quad.desc.normals = broken;
  snapshot = commit_quad(&scene, quad.make(), Mat4(1.0f), Mat4(1.0f), Mat4(1.0f));
  EXPECT_TRUE(is_finite(snapshot->surface_point(hit_at(Vec2(0.9f, 0))).shading_normal));
}

TEST(SurfacePoint, CornersWithoutANormalUseThatOfTheirVertex) {
  const float some[12] = {0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 1};
  Quad quad;
  quad.desc.normal_domain = GRADUS_DOMAIN_CORNER;
  quad.desc.normals = some;
  scene::Scene scene(test_device());
  const auto snapshot = commit_quad(&scene, quad.make(), Mat4(1.0f), Mat4(1.0f), Mat4(1.0f));
  EXPECT_LT(glm::length(snapshot->surface_point(hit_at(Vec2(0.5f, 0.0f))).shading_normal - Vec3(0, 0, 1)), 1e-6f);
  EXPECT_GT(snapshot->surface_point(hit_at(Vec2(0, 0.9f))).shading_normal.y, 0.5f);
}

TEST(Materials, SlotsBeyondTheLastUseTheLast) {
  Quad quad;
  quad.face_materials = {7};
  TestScene scene;
  scene.material(3, MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.5f)));
  scene.scene.set_mesh(1, quad.make());
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 3);
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 99);  // a key that was never set: the default grey
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->material_of(0, 0), 1u);
  EXPECT_EQ(snapshot->material_of(1, 0), 0u);
}

}  // namespace
}  // namespace gradus::test::mesh_test
