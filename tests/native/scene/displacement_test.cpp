// Displacement of vertices in the commit, and as a bump, against closed forms.
#include <limits>

#include <gtest/gtest.h>

#include "geometry/displaced_mesh.h"
#include "geometry/mesh.h"
#include "scene/moved_snapshot.h"
#include "scene_fixture.h"
#include "shading/material.h"
#include "shading/program_builder.h"
#include "shading/shade.h"

namespace gradus::test::displacement_test {
namespace {

constexpr uint64_t kMesh = 1, kMaterial = 1;

// A diffuse material with a displacement.
class Displaced : public ProgramBuilder {
 public:
  GradusMaterial desc(int displacement, uint32_t method, uint32_t output = 0) {
    const int surface = add(GRADUS_OP_DIFFUSE, {In(Vec3(0.5f)), In(0.0f), In(0.0f)});
    GradusMaterial d = ProgramBuilder::desc(surface);
    d.displacement = uint32_t(displacement) + 1;
    d.displacement_output = output;
    d.displacement_method = method;
    d.bump_filter_width = 1.0f;
    return d;
  }
};

// Sets a material that moves vertices by `height` along their normals.
void set_height(float height, uint32_t space, TestScene* scene, uint32_t method = GRADUS_DISPLACEMENT_VERTICES) {
  Displaced d;
  const int node = d.add(GRADUS_OP_DISPLACEMENT, {In(height), In(0.0f), In(1.0f), In(Vec3(0.0f))}, space);
  scene->scene.set_material(kMaterial, d.desc(node, method));
}

// Sets a material that lifts the floor by slope · x.
void set_slope(float slope, uint32_t method, TestScene* scene) {
  Displaced d;
  const int place = d.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_OBJECT);
  const int height = d.add(GRADUS_OP_VECTOR_MATH, {In::from(place), In(Vec3(slope, 0, 0)), In(0.0f), In(1.0f)},
                           GRADUS_VECTOR_DOT_PRODUCT);
  const int node =
      d.add(GRADUS_OP_DISPLACEMENT, {In::from(height, 1), In(0.0f), In(1.0f), In(Vec3(0.0f))}, GRADUS_NORMAL_WORLD);
  scene->scene.set_material(kMaterial, d.desc(node, method));
}

// A floor z = 0 from -1 to 1.
Soup floor_soup() {
  Soup soup;
  soup.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  soup.vertices = {0, 1, 2, 0, 2, 3};
  return soup;
}

std::shared_ptr<const scene::Snapshot> ball(float height, uint32_t space, const Mat4& matrix) {
  TestScene scene;
  scene.mesh(kMesh, sphere(Vec3(0.0f), 1.0f, 64, 128));
  set_height(height, space, &scene);
  scene.instance(kMesh, matrix, GRADUS_VISIBLE_ALL, kMaterial);
  return scene.commit();
}

geometry::Hit hit_from(const scene::Snapshot& snapshot, const Vec3& from, const Vec3& direction) {
  geometry::Hit hit;
  EXPECT_TRUE(snapshot.intersect({from, 0.0f, direction, kInfinity}, GRADUS_VISIBLE_ALL, &hit));
  return hit;
}

// Returns the normal of the diffuse lobe below (0.1, 0.2).
Vec3 lobe_normal(const scene::Snapshot& snapshot) {
  const geometry::Hit hit = hit_from(snapshot, Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1));
  shading::ShadeResult result;
  shading::shade_surface(snapshot, snapshot.surface_point(hit), Vec3(0, 0, 1), {}, 0.1f, &result);
  EXPECT_EQ(result.closures.count(), 1);
  return result.closures.lobe(0).normal;
}

TEST(Displacement, BallGrows) {
  const auto snapshot = ball(0.5f, GRADUS_NORMAL_OBJECT, Mat4(1.0f));
  EXPECT_NEAR(hit_from(*snapshot, Vec3(5, 0.01f, 0.02f), Vec3(-1, 0, 0)).t, 3.5f, 5e-3f);
  EXPECT_NEAR(snapshot->radius, 1.5f * std::sqrt(3.0f), 1e-3f);
}

// In object space the height scales with the object, in world space it does not.
TEST(Displacement, SpacesOfTheHeight) {
  const auto local = ball(0.5f, GRADUS_NORMAL_OBJECT, scaling(Vec3(2.0f)));
  EXPECT_NEAR(hit_from(*local, Vec3(5, 0.01f, 0.02f), Vec3(-1, 0, 0)).t, 2.0f, 1e-2f);
  const auto world = ball(0.5f, GRADUS_NORMAL_WORLD, scaling(Vec3(2.0f)));
  EXPECT_NEAR(hit_from(*world, Vec3(5, 0.01f, 0.02f), Vec3(-1, 0, 0)).t, 2.5f, 1e-2f);
}

TEST(Displacement, VectorInWorldSpace) {
  TestScene scene;
  scene.mesh(kMesh, floor_soup());
  Displaced d;
  const int node =
      d.add(GRADUS_OP_VECTOR_DISPLACEMENT, {In(Vec3(1.0f, 1.0f, 4.0f)), In(1.0f), In(2.0f)}, GRADUS_NORMAL_WORLD);
  scene.scene.set_material(kMaterial, d.desc(node, GRADUS_DISPLACEMENT_VERTICES));
  scene.instance(kMesh, scaling(Vec3(3.0f)), GRADUS_VISIBLE_ALL, kMaterial);
  EXPECT_NEAR(hit_from(*scene.commit(), Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1)).t, 4.0f, 1e-4f);
}

// With Vertices the surface and its normal tilt; with Bump the normal alone; with Both they tilt once, not twice.
TEST(Displacement, SlopeOfAFloor) {
  const Vec3 tilted = glm::normalize(Vec3(-0.5f, 0, 1));
  for (const uint32_t method : {GRADUS_DISPLACEMENT_BUMP, GRADUS_DISPLACEMENT_VERTICES, GRADUS_DISPLACEMENT_BOTH}) {
    TestScene scene;
    scene.mesh(kMesh, floor_soup());
    set_slope(0.5f, method, &scene);
    scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
    const auto snapshot = scene.commit();
    const geometry::Hit hit = hit_from(*snapshot, Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1));
    const bool moves = method != GRADUS_DISPLACEMENT_BUMP;
    EXPECT_NEAR(hit.t, moves ? 10.0f - 0.05f : 10.0f, 1e-4f) << method;
    const Vec3 plane = snapshot->surface_point(hit).geometric_normal;
    EXPECT_NEAR(glm::dot(plane, moves ? tilted : Vec3(0, 0, 1)), 1.0f, 1e-5f) << method;
    EXPECT_NEAR(glm::dot(lobe_normal(*snapshot), tilted), 1.0f, 1e-3f) << method;
  }
}

// Programs that read the normal see the bump, and the others do not compute it.
TEST(Displacement, BumpsProgramsThatReadTheNormal) {
  for (const uint32_t mode : {GRADUS_GEOMETRY_NORMAL, GRADUS_GEOMETRY_POSITION}) {
    TestScene scene;
    scene.mesh(kMesh, floor_soup());
    Displaced d;
    const int place = d.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_OBJECT);
    const int slope = d.add(GRADUS_OP_VECTOR_MATH, {In::from(place), In(Vec3(0.5f, 0, 0)), In(0.0f), In(1.0f)},
                            GRADUS_VECTOR_DOT_PRODUCT);
    const int height =
        d.add(GRADUS_OP_DISPLACEMENT, {In::from(slope, 1), In(0.0f), In(1.0f), In(Vec3(0.0f))}, GRADUS_NORMAL_WORLD);
    const int value = d.add(GRADUS_OP_GEOMETRY, {}, mode);
    const int emission = d.add(GRADUS_OP_EMISSION, {In::from(value), In(1.0f)});
    GradusMaterial desc = d.desc(height, GRADUS_DISPLACEMENT_BUMP);
    desc.surface = emission;
    scene.scene.set_material(kMaterial, desc);
    scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
    const auto snapshot = scene.commit();
    const geometry::Hit hit = hit_from(*snapshot, Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1));
    const Rgb found = shading::shade_emission(*snapshot, snapshot->surface_point(hit), Vec3(0, 0, 1), {});
    const bool reads = mode == GRADUS_GEOMETRY_NORMAL;
    EXPECT_EQ(snapshot->materials[snapshot->material_of(hit)]->bumps_emission, reads);
    EXPECT_LT(glm::distance(found, reads ? glm::normalize(Vec3(-0.5f, 0, 1)) : Vec3(0.1f, 0.2f, 0.0f)), 1e-3f);
  }
}

// Before Blender 5.0 the bump of a flat face starts from the moved face, so that it tilts twice.
TEST(Displacement, SlopeOfAMovedFace) {
  TestScene scene;
  scene.mesh(kMesh, floor_soup());
  set_slope(0.2f, GRADUS_DISPLACEMENT_BOTH_OF_FACES, &scene);
  scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  const Vec3 normal = lobe_normal(*scene.commit());
  EXPECT_LT(normal.x, -0.3f);
}

TEST(Displacement, NotFiniteOrTooLargeStaysWithAWarning) {
  for (const float height : {std::numeric_limits<float>::quiet_NaN(), kInfinity, 1e30f}) {
    TestScene scene;
    scene.mesh(kMesh, floor_soup());
    set_height(height, GRADUS_NORMAL_OBJECT, &scene);
    scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
    const auto snapshot = scene.commit();
    ASSERT_EQ(snapshot->warnings.size(), 1u) << height;
    EXPECT_NE(snapshot->warnings[0].find("not finite or too large"), std::string::npos);
    EXPECT_NEAR(hit_from(*snapshot, Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1)).t, 10.0f, 1e-4f);
  }
}

// Faces without area and meshes without faces have no normals to move along.
TEST(Displacement, WithoutNormals) {
  TestScene scene;
  Soup line = floor_soup();
  line.positions = {{-1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
  scene.mesh(kMesh, line);
  scene.mesh(2, Soup());
  set_height(1.0f, GRADUS_NORMAL_OBJECT, &scene);
  scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  scene.instance(2, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  EXPECT_TRUE(scene.commit()->warnings.empty());
}

TEST(Displacement, InstancesShareTheMesh) {
  TestScene scene;
  scene.mesh(kMesh, floor_soup());
  set_height(0.5f, GRADUS_NORMAL_OBJECT, &scene);
  scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  scene.instance(kMesh, translation(Vec3(5, 0, 0)), GRADUS_VISIBLE_ALL, kMaterial);
  scene.instance(kMesh, translation(Vec3(10, 0, 0)));
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->instances[0].mesh, snapshot->instances[1].mesh);
  EXPECT_NE(snapshot->instances[0].mesh, snapshot->instances[2].mesh);
}

// An unchanged displacement is not evaluated again, and a changed one is.
TEST(Displacement, IsKeptUntilItChanges) {
  TestScene scene;
  scene.mesh(kMesh, floor_soup());
  set_height(0.5f, GRADUS_NORMAL_OBJECT, &scene);
  scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  const auto first = scene.commit();
  EXPECT_EQ(scene.commit()->instances[0].mesh, first->instances[0].mesh);
  set_height(0.75f, GRADUS_NORMAL_OBJECT, &scene);
  const auto second = scene.commit();
  EXPECT_NE(second->content_key, first->content_key);
  EXPECT_NEAR(hit_from(*second, Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1)).t, 9.25f, 1e-4f);
  scene.move(0, scaling(Vec3(2.0f)));
  EXPECT_NEAR(hit_from(*scene.commit(), Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1)).t, 8.5f, 1e-4f);
}

// Nodes that trace rays have nothing to trace yet.
TEST(Displacement, ByAmbientOcclusion) {
  TestScene scene;
  scene.mesh(kMesh, floor_soup());
  Displaced d;
  const int open = d.add(GRADUS_OP_AMBIENT_OCCLUSION, {In(1.0f), In(10.0f), In(0.0f)}, 0, {4.0f});
  const int bevel = d.add(GRADUS_OP_BEVEL, {In(0.5f), In(0.0f)}, 0, {4.0f});
  const int node =
      d.add(GRADUS_OP_DISPLACEMENT, {In::from(open, 1), In(0.0f), In(1.0f), In::from(bevel)}, GRADUS_NORMAL_OBJECT);
  scene.scene.set_material(kMaterial, d.desc(node, GRADUS_DISPLACEMENT_VERTICES));
  scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  EXPECT_NEAR(hit_from(*scene.commit(), Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1)).t, 9.0f, 1e-4f);
}

// Another moment of the frame moves the surface that bumps start from along with the displaced one.
TEST(Displacement, MovedSnapshotBumpsAlike) {
  TestScene scene;
  scene.mesh(kMesh, floor_soup());
  set_slope(0.5f, GRADUS_DISPLACEMENT_BOTH, &scene);
  scene.instance(kMesh, Mat4(1.0f), GRADUS_VISIBLE_ALL, kMaterial);
  scene.matrices_before = {Mat4(1.0f)};
  scene.matrices_after = {translation(Vec3(0, 0, 3))};
  const auto moved = scene::moved_snapshot(
      *scene.commit(), Moment::Next, [] { return false; }, 1.0f);
  EXPECT_NEAR(hit_from(*moved, Vec3(0.1f, 0.2f, 10.0f), Vec3(0, 0, -1)).t, 6.95f, 1e-4f);
  EXPECT_NEAR(glm::dot(lobe_normal(*moved), glm::normalize(Vec3(-0.5f, 0, 1))), 1.0f, 1e-3f);
}

// All keys of a mesh that moves are displaced, and generated coordinates stay with the vertices.
TEST(DisplacedMesh, MovesAllKeys) {
  const std::array<float, 18> keys{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 1, 0, 5, 0, 1, 5};
  const std::array<float, 2> times{0.0f, 1.0f};
  MeshDesc desc(Soup{"mesh", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2}});
  desc.desc.key_count = 2;
  desc.desc.key_times = times.data();
  desc.desc.positions = keys.data();
  desc.desc.shutter_key_count = 2;
  desc.desc.shutter_positions = keys.data();
  desc.desc.normal_domain = GRADUS_DOMAIN_POINT;
  const auto mesh = geometry::make_mesh(desc.desc);
  const std::vector<Vec3> offsets{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}};
  const auto moved = geometry::displaced_mesh(*mesh, offsets, {true});
  for (const auto* positions : {&moved->positions, &moved->shutter_positions}) {
    EXPECT_EQ((*positions)[1], Vec3(1, 0, 1));
    EXPECT_EQ((*positions)[4], Vec3(1, 0, 6));
  }
  EXPECT_EQ(moved->upper.z, 1.0f);
  EXPECT_NEAR(glm::dot(moved->normals[0], glm::normalize(Vec3(-1, 0, 1))), 1.0f, 1e-6f);
  EXPECT_EQ(geometry::generated_at(*moved, 0, Vec2(1, 0)), geometry::generated_at(*mesh, 0, Vec2(1, 0)));
  EXPECT_NE(moved->content_hash, mesh->content_hash);
  EXPECT_EQ(moved->topology_hash, mesh->topology_hash);
}

}  // namespace
}  // namespace gradus::test::displacement_test
