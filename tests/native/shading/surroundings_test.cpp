// Nodes that look at the surroundings of the point, and values of the instance, against closed forms.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "image/image_store.h"
#include "scene/scene_fixture.h"
#include "shading/context.h"
#include "shading/material.h"
#include "shading/program_builder.h"

namespace gradus::test::surroundings_test {
namespace {

constexpr uint64_t kFloor = 1, kWall = 2;

void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Soup* soup) {
  soup->triangle(a, b, c);
  soup->triangle(a, c, d);
}

// The floor z = 0 for x < 0, and a wall from its edge x = 0 to the height 1 that faces −x. They are one instance or
// two.
std::shared_ptr<const scene::Snapshot> corner(bool one_instance) {
  TestScene scene;
  Soup floor, wall;
  add_quad(Vec3(-50, -50, 0), Vec3(0, -50, 0), Vec3(0, 50, 0), Vec3(-50, 50, 0), &floor);
  add_quad(Vec3(0, -50, 0), Vec3(0, -50, 1), Vec3(0, 50, 1), Vec3(0, 50, 0), one_instance ? &floor : &wall);
  scene.mesh(kFloor, floor);
  scene.instance(kFloor);
  if (!one_instance) {
    scene.mesh(kWall, wall);
    scene.instance(kWall);
  }
  return scene.commit();
}

shading::ShadeContext context_below(const scene::Snapshot& scene, const Vec3& from, uint32_t sample) {
  geometry::Hit hit;
  EXPECT_TRUE(scene.intersect({from, 0.0f, Vec3(0, 0, -1)}, GRADUS_VISIBLE_ALL, &hit));
  shading::RayState ray;
  ray.random = sample + 1;
  return shading::surface_context(scene, scene.surface_point(hit), Vec3(0, 0, 1), ray);
}

// Returns the mean of an operation over many samples.
Rgb mean(const scene::Snapshot& scene, const Vec3& from, uint32_t op, const std::vector<In>& inputs, uint32_t mode,
         float rays, uint32_t output) {
  constexpr uint32_t kSamples = 200;
  Rgb sum(0.0f);
  for (uint32_t i = 0; i < kSamples; ++i)
    sum += evaluate(op, inputs, mode, {rays}, output, context_below(scene, from, i));
  return sum / float(kSamples);
}

float occlusion(const scene::Snapshot& scene, float distance, uint32_t mode) {
  const std::vector<In> inputs{In(1.0f), In(distance), In(0.0f)};
  return mean(scene, Vec3(-0.75f, 0.0f, 0.5f), GRADUS_OP_AMBIENT_OCCLUSION, inputs, mode, 16.0f, 1).x;
}

// An infinite wall of height h at distance d hides (1 − d / √(d² + h²)) / 2 of the cosine-weighted hemisphere.
TEST(AmbientOcclusion, OfAWall) {
  const float expected = 1.0f - 0.5f * (1.0f - 0.75f / 1.25f);
  EXPECT_NEAR(occlusion(*corner(false), 1000.0f, 0), expected, 0.01f);
  EXPECT_NEAR(occlusion(*corner(true), 1000.0f, 0), expected, 0.01f);
}

TEST(AmbientOcclusion, WithinTheDistanceAlone) {
  EXPECT_EQ(occlusion(*corner(true), 0.7f, 0), 1.0f);
  EXPECT_EQ(occlusion(*corner(true), 0.0f, 0), 1.0f);
  EXPECT_LT(occlusion(*corner(true), 0.9f, 0), 1.0f);
}

TEST(AmbientOcclusion, OnlyLocalLeavesOutOtherInstances) {
  EXPECT_EQ(occlusion(*corner(false), 1000.0f, 2), 1.0f);
  EXPECT_NEAR(occlusion(*corner(true), 1000.0f, 2), 0.8f, 0.01f);
}

// Below the floor there is nothing.
TEST(AmbientOcclusion, Inside) { EXPECT_EQ(occlusion(*corner(true), 1000.0f, 1), 1.0f); }

// A path sees the same again if it is replayed, and another path sees something else.
TEST(AmbientOcclusion, DependsOnTheSampleAlone) {
  const auto scene = corner(true);
  const auto of = [&](uint32_t sample) {
    return evaluate(GRADUS_OP_AMBIENT_OCCLUSION, {In(1.0f), In(10.0f), In(0.0f)}, 0, {64.0f}, 1,
                    context_below(*scene, Vec3(-0.75f, 0.0f, 0.5f), sample))
        .x;
  };
  EXPECT_EQ(of(3), of(3));
  int different = 0;
  for (uint32_t i = 0; i < 10; ++i) different += of(i) != of(i + 1) ? 1 : 0;
  EXPECT_GT(different, 3);
}

Rgb bevel_at(const scene::Snapshot& scene, float x) {
  return mean(scene, Vec3(x, 0.3f, 0.5f), GRADUS_OP_BEVEL, {In(0.2f), In(0.0f)}, 0, 16.0f, 0);
}

TEST(Bevel, KeepsThePlane) {
  const Rgb normal = bevel_at(*corner(true), -0.75f);
  EXPECT_NEAR(normal.z, 1.0f, 1e-5f);
}

// At the edge, both planes have the same share: the normal is the mean of theirs.
TEST(Bevel, MeetsInTheMiddleOfAnEdge) {
  const Rgb normal = glm::normalize(bevel_at(*corner(true), -1e-4f));
  EXPECT_NEAR(normal.x, -std::sqrt(0.5f), 0.02f);
  EXPECT_NEAR(normal.y, 0.0f, 0.02f);
  EXPECT_NEAR(normal.z, std::sqrt(0.5f), 0.02f);
}

TEST(Bevel, IgnoresOtherInstances) { EXPECT_NEAR(bevel_at(*corner(false), -1e-4f).z, 1.0f, 1e-5f); }

// Returns an output of a ray from the floor, in a direction that is longer than 1, towards the wall.
Rgb raycast(const scene::Snapshot& scene, uint32_t output, float length, uint32_t mode = 0) {
  const shading::ShadeContext context = context_below(scene, Vec3(-0.75f, 0.3f, 0.5f), 0);
  const std::vector<In> inputs{In(shading::world_position(context)), In(Vec3(2.0f, 0.0f, 1.0f)), In(length)};
  return evaluate(GRADUS_OP_RAYCAST, inputs, mode, {}, output, context);
}

TEST(Raycast, MeetsTheWall) {
  for (const bool one_instance : {true, false}) {
    const auto scene = corner(one_instance);
    EXPECT_EQ(raycast(*scene, 0, 1.0f).x, 1.0f);
    EXPECT_EQ(raycast(*scene, 1, 1.0f).x, one_instance ? 1.0f : 0.0f);
    EXPECT_NEAR(raycast(*scene, 2, 1.0f).x, 0.375f, 1e-5f);
    EXPECT_NEAR(glm::distance(raycast(*scene, 3, 1.0f), Rgb(0.0f, 0.3f, 0.375f)), 0.0f, 1e-5f);
    EXPECT_NEAR(glm::distance(raycast(*scene, 4, 1.0f), Rgb(-1.0f, 0.0f, 0.0f)), 0.0f, 1e-5f);
  }
}

TEST(Raycast, EndsAtItsLengthAndAtItsInstance) {
  for (const float length : {0.37f, 0.0f}) {
    EXPECT_EQ(raycast(*corner(true), 0, length).x, 0.0f);
    EXPECT_EQ(raycast(*corner(true), 2, length).x, length);
    EXPECT_EQ(raycast(*corner(true), 3, length), Rgb(0.0f));
  }
  EXPECT_EQ(raycast(*corner(false), 0, 1.0f, 1).x, 0.0f);
  EXPECT_EQ(raycast(*corner(true), 0, 1.0f, 1).x, 1.0f);
}

// Rays that are no rays meet nothing, as in Cycles; one of infinite length is a ray.
TEST(Raycast, OfInputsThatAreNotFinite) {
  const auto scene = corner(true);
  const shading::ShadeContext context = context_below(*scene, Vec3(-0.75f, 0.3f, 0.5f), 0);
  const Vec3 position = shading::world_position(context), direction(2.0f, 0.0f, 1.0f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto hit = [&](const Vec3& from, const Vec3& to, float length) {
    return evaluate(GRADUS_OP_RAYCAST, {In(from), In(to), In(length)}, 0, {}, 0, context).x;
  };
  EXPECT_EQ(hit(position, direction, kInfinity), 1.0f);
  for (const float bad : {nan, kInfinity, -kInfinity})
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 from = position, to = direction;
      from[axis] = to[axis] = bad;
      EXPECT_EQ(hit(from, direction, 1.0f), 0.0f);
      EXPECT_EQ(hit(position, to, 1.0f), 0.0f);
    }
  for (const float length : {nan, -kInfinity, -1.0f}) EXPECT_EQ(hit(position, direction, length), 0.0f);
  for (const float tiny : {0.0f, 1e-30f}) EXPECT_EQ(hit(position, direction * tiny, kInfinity), 0.0f);
}

// Returns an attribute of a sphere, with the value (x, y, z) at its vertices, where a ray of a material ends.
Rgb raycast_attribute(const char* name, const Vec3& direction, uint32_t output) {
  TestScene scene;
  MeshDesc desc(sphere(Vec3(0.0f), 1.0f, 64, 128));
  GradusAttribute place{sizeof(GradusAttribute), GRADUS_DOMAIN_POINT, 3, 0, "place", desc.desc.positions};
  desc.desc.attributes = &place;
  desc.desc.attribute_count = 1;
  scene.scene.set_mesh(kFloor, desc.desc);
  scene.instance(kFloor);
  const auto snapshot = scene.commit();
  ProgramBuilder b;
  const int ray = b.add(GRADUS_OP_RAYCAST, {In(Vec3(0.0f)), In(direction), In(5.0f)});
  const int node = b.add(GRADUS_OP_RAYCAST_ATTRIBUTE, {In::from(ray, 5)}, 0, {}, 1);
  GradusMaterial material = b.desc(b.add(GRADUS_OP_EMISSION, {In::from(node, output), In(1.0f)}));
  material.names = &name;
  material.name_count = 1;
  const auto compiled = shading::compile_material(material, image::ImageStore());
  return run(compiled->surface, context_below(*snapshot, Vec3(0.1f, 0.2f, 3.0f), 0)).emission;
}

// The attribute is that of the place where the ray ends, and the material traces one ray for all its attributes.
TEST(Raycast, ReadsAttributesWhereItEnds) {
  const Vec3 direction = glm::normalize(Vec3(0.3f, 0.5f, 0.7f));
  EXPECT_NEAR(glm::distance(raycast_attribute("place", direction, 0), Rgb(direction)), 0.0f, 0.01f);
  EXPECT_NEAR(raycast_attribute("place", direction, 3).x, 1.0f, 1e-5f);
  EXPECT_EQ(raycast_attribute("nothing", direction, 0), Rgb(0.0f));
  EXPECT_EQ(raycast_attribute("nothing", direction, 3), Rgb(1.0f));
  EXPECT_EQ(raycast_attribute("place", Vec3(0.0f), 3), Rgb(0.0f));
}

// A program may name any surface; one that does not exist has no attributes.
TEST(Raycast, RefusesSurfacesThatDoNotExist) {
  const auto scene = corner(true);
  const shading::ShadeContext context = context_below(*scene, Vec3(-0.75f, 0.3f, 0.5f), 0);
  for (const float bits : {1e-40f, 1.0f, -1.0f})
    EXPECT_EQ(evaluate(GRADUS_OP_RAYCAST_ATTRIBUTE, {In(Vec3(bits))}, 0, {}, 3, context), Rgb(0.0f));
}

// The edges of the floor's triangles that are near are x = 0 and a diagonal.
TEST(Wireframe, LinesAreAsWideAsTheirSize) {
  const auto scene = corner(true);
  const auto at = [&](float x, float size) {
    return evaluate(GRADUS_OP_WIREFRAME, {In(size)}, 0, {0.01f, 0.01f}, 0,
                    context_below(*scene, Vec3(x, 20.0f, 0.5f), 0))
        .x;
  };
  EXPECT_EQ(at(-0.04f, 0.1f), 1.0f);
  EXPECT_EQ(at(-0.06f, 0.1f), 0.0f);
  EXPECT_EQ(at(-0.06f, 0.13f), 1.0f);
}

TEST(InstanceAttribute, IsThatOfItsName) {
  TestScene scene;
  scene.mesh(kFloor, sphere(Vec3(0.0f), 1.0f, 6, 6));
  scene.instance(kFloor);
  const uint64_t meshes[] = {kFloor, kFloor};
  const Mat4 matrices[] = {translation(Vec3(0.0f)), translation(Vec3(5, 0, 0))};
  const char* names[] = {"a", "b"};
  const float values[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  GradusInstances instances{};
  instances.struct_size = sizeof(instances);
  instances.count = 2;
  instances.meshes = meshes;
  instances.matrices = &matrices[0][0][0];
  instances.attribute_count = 2;
  instances.attribute_names = names;
  instances.attributes = values;
  scene.scene.set_instances(instances);
  scene.scene.commit(nullptr, nullptr);
  const auto snapshot = scene.scene.snapshot();
  const auto color = [&](const char* name, float x, uint32_t output) {
    ProgramBuilder b;
    const int node = b.add(GRADUS_OP_INSTANCE_ATTRIBUTE, {}, 0, {}, 1);
    GradusMaterial desc = b.desc(b.add(GRADUS_OP_EMISSION, {In::from(node, output), In(1.0f)}));
    desc.surface = 1;
    desc.names = &name;
    desc.name_count = 1;
    const auto material = shading::compile_material(desc, image::ImageStore());
    return run(material->surface, context_below(*snapshot, Vec3(x, 0, 3), 0)).emission;
  };
  EXPECT_EQ(color("a", 0, 0), Rgb(1, 2, 3));
  EXPECT_EQ(color("a", 5, 0), Rgb(5, 6, 7));
  EXPECT_EQ(color("b", 5, 1), Rgb(13, 14, 15));
  EXPECT_EQ(color("b", 0, 2), Rgb(10));
  EXPECT_EQ(color("b", 0, 3), Rgb(12));
  EXPECT_EQ(color("c", 0, 0), Rgb(0));
}

}  // namespace
}  // namespace gradus::test::surroundings_test
