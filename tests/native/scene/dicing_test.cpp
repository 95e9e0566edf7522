// Dicing: division of meshes until their edges are short, against closed forms.
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "base/clock.h"
#include "base/error.h"
#include "geometry/diced_mesh.h"
#include "geometry/dicing_tree.h"
#include "geometry/mesh.h"
#include "motion/snapshot_motion.h"
#include "scene/dice_instances.h"
#include "scene_fixture.h"
#include "shading/program_builder.h"

namespace gradus::test::dicing_test {
namespace {

// An octahedron with shared vertices and the normals of the unit sphere.
Soup octahedron() {
  Soup soup;
  soup.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  soup.vertices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  return soup;
}

Soup square() {
  Soup soup;
  soup.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  soup.vertices = {0, 1, 2, 0, 2, 3};
  return soup;
}

// Dices a mesh until no edge is longer than `length`.
std::shared_ptr<const geometry::MeshData> diced(std::shared_ptr<const geometry::MeshData> mesh,
                                                const geometry::EdgeExcess& excess) {
  const CommitMonitor monitor(nullptr, nullptr);
  geometry::Dicing dicing(std::move(mesh), excess, monitor);
  while (dicing.largest_excess() > 1.0f) dicing.divide(std::max(1.0f, dicing.largest_excess() / 1.4f), monitor);
  return geometry::diced_mesh(dicing, monitor);
}

geometry::EdgeExcess longer_than(float length) {
  return [=](const Vec3& a, const Vec3& b) { return glm::distance(a, b) / length; };
}

// The longest edge may be shorter on one side of the mesh.
geometry::EdgeExcess longer_than_by_place(float length) {
  return [=](const Vec3& a, const Vec3& b) { return glm::distance(a, b) / length * std::exp(-(a.x + b.x)); };
}

std::shared_ptr<const geometry::MeshData> smooth_octahedron(uint32_t levels = 12) {
  MeshDesc desc(octahedron());
  desc.desc.normal_domain = GRADUS_DOMAIN_POINT;
  desc.desc.dicing_levels = levels;
  return geometry::make_mesh(desc.desc);
}

float longest_edge(const geometry::MeshData& mesh) {
  float longest = 0.0f;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const auto p = geometry::triangle_positions(mesh, t);
    for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(p[k], p[(k + 1) % 3]));
  }
  return longest;
}

// In a closed surface each edge belongs to two triangles, which pass it in opposite directions. Small triangles beside
// large ones must not open it.
TEST(DicedMesh, HasNoCracks) {
  const auto mesh = diced(smooth_octahedron(), longer_than_by_place(0.1f));
  EXPECT_EQ(mesh->vertex_count, mesh->triangle_count / 2 + 2);
  EXPECT_EQ(mesh->normals.size(), mesh->vertex_count);
  std::map<std::pair<uint32_t, uint32_t>, int> directions;
  for (uint32_t i = 0; i < mesh->triangle_count * 3; ++i)
    ++directions[std::pair(mesh->triangle_vertices[i], mesh->triangle_vertices[i / 3 * 3 + (i + 1) % 3])];
  for (const auto& [edge, count] : directions) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(directions.count({edge.second, edge.first}), 1u);
  }
}

TEST(DicedMesh, HasEdgesAsShortAsAskedFor) {
  const auto mesh = diced(smooth_octahedron(), longer_than(0.1f));
  EXPECT_LE(longest_edge(*mesh), 0.1f);
  EXPECT_GT(longest_edge(*mesh), 0.06f);
  // Triangles are divided at most as often as the levels say, but for what neighbours need.
  EXPECT_NEAR(diced(smooth_octahedron(3), longer_than(1e-4f))->triangle_count, 8u << 6, 100);
}

TEST(DicedMesh, HasSmallTrianglesOnlyWhereTheyAreAskedFor) {
  const auto mesh = diced(smooth_octahedron(), longer_than_by_place(0.1f));
  std::array<size_t, 2> count{};
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    const auto p = geometry::triangle_positions(*mesh, t);
    ++count[p[0].x + p[1].x + p[2].x > 0.0f ? 0 : 1];
  }
  EXPECT_GT(count[1], 3 * count[0]);
}

// Triangles do not become needles: bisection of the longest edge keeps their angles.
TEST(DicedMesh, KeepsTheShapeOfTriangles) {
  const auto mesh = diced(smooth_octahedron(), longer_than_by_place(0.05f));
  float worst = 1.0f;
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    const auto p = geometry::triangle_positions(*mesh, t);
    float longest = 0.0f;
    for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(p[k], p[(k + 1) % 3]));
    worst = std::min(worst, glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / (longest * longest));
  }
  EXPECT_GT(worst, 0.1f);
}

// Patches come near the sphere: in the middle they have 4 / √27 of its radius, where flat triangles have 1 / √3.
TEST(DicedMesh, CurvesAlongNormals) {
  const auto mesh = diced(smooth_octahedron(), longer_than_by_place(0.2f));
  for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
    const Vec3& p = mesh->frame_positions()[i];
    EXPECT_GT(glm::length(p), 0.769f) << i;
    EXPECT_LT(glm::length(p), 1.001f) << i;
    EXPECT_GT(glm::dot(mesh->normals[i], glm::normalize(p)), 0.95f) << i;
  }
}

// A point of one diced mesh is the same point of the mesh before and of another diced mesh.
TEST(DicedMesh, CorrespondsToOtherDicings) {
  const auto from = diced(smooth_octahedron(), longer_than_by_place(0.2f));
  const auto to = diced(smooth_octahedron(), longer_than(0.1f));
  EXPECT_NE(from->topology_hash, to->topology_hash);
  EXPECT_EQ(from->dicing->topology_hash, to->dicing->topology_hash);
  for (uint32_t t = 0; t < from->triangle_count; ++t) {
    const geometry::TrianglePoint base = from->dicing->to_base({t, Vec2(0.3f, 0.45f)});
    const geometry::TrianglePoint back = from->dicing->from_base(base);
    const geometry::TrianglePoint there = to->dicing->from_base(base);
    EXPECT_EQ(back.triangle, t);
    EXPECT_NEAR(back.uv.x, 0.3f, 1e-3f);
    EXPECT_NEAR(back.uv.y, 0.45f, 1e-3f);
    const geometry::TrianglePoint again = to->dicing->to_base(there);
    EXPECT_EQ(again.triangle, base.triangle);
    EXPECT_NEAR(again.uv.x, base.uv.x, 1e-5f);
    EXPECT_NEAR(again.uv.y, base.uv.y, 1e-5f);
  }
}

TEST(DicedMesh, IsCancelledInsideOfAMesh) {
  volatile int32_t cancel = 0;
  const CommitMonitor monitor(&cancel, nullptr);
  const auto excess = [&](const Vec3& a, const Vec3& b) {
    if (glm::distance(a, b) < 0.1f) cancel = 1;
    return 10.0f;
  };
  geometry::Dicing dicing(smooth_octahedron(), excess, monitor);
  const auto run = [&] {
    for (;;) dicing.divide(1.0f, monitor);
  };
  EXPECT_THROW(run(), Error);
  EXPECT_LT(dicing.triangles().size(), 10000u);
}

TEST(DicedMesh, KeepsPlanesAndAttributes) {
  MeshDesc desc(square());
  const std::array<float, 12> corners{-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1};
  const std::array<float, 4> points{0, 2, 4, 2};
  std::array<GradusAttribute, 2> attributes{};
  attributes[0] = {sizeof(GradusAttribute), GRADUS_DOMAIN_CORNER, 2, 1, "uv", corners.data()};
  attributes[1] = {sizeof(GradusAttribute), GRADUS_DOMAIN_POINT, 1, 0, "sum", points.data()};
  desc.desc.attributes = attributes.data();
  desc.desc.attribute_count = 2;
  desc.desc.dicing_levels = 12;
  const auto mesh = diced(geometry::make_mesh(desc.desc), longer_than_by_place(0.3f));
  EXPECT_GT(mesh->triangle_count, 100u);
  float area = 0.0f;
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    const auto p = geometry::triangle_positions(*mesh, t);
    const auto uv = geometry::corner_values(*mesh, mesh->attributes[0], t);
    const auto sum = geometry::corner_values(*mesh, mesh->attributes[1], t);
    EXPECT_GT(glm::cross(p[1] - p[0], p[2] - p[0]).z, 0.0f);
    area += glm::cross(p[1] - p[0], p[2] - p[0]).z * 0.5f;
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(p[k].z, 0.0f);
      EXPECT_EQ(Vec2(uv[k]), Vec2(p[k]));
      EXPECT_NEAR(sum[k].x, p[k].x + p[k].y + 2.0f, 1e-6f);
    }
  }
  EXPECT_NEAR(area, 4.0f, 1e-5f);
}

// Places a camera at a height. It looks down, and what it sees is half as wide as its height.
void set_camera(float height, TestScene* scene) {
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  camera.type = GRADUS_CAMERA_PERSPECTIVE;
  const std::array<float, 4> window{-0.25f, 0.25f, -0.25f, 0.25f};
  set_static(&camera, window.data(), translation(Vec3(0, 0, height)));
  scene->scene.set_camera(camera);
}

// Commits a square that is diced, 4 m below a camera that sees 2 m of it in width.
std::shared_ptr<const scene::Snapshot> commit(float rate, float length, uint32_t levels, float scale = 1.0f) {
  TestScene scene;
  MeshDesc desc(square());
  desc.desc.dicing_levels = levels;
  desc.desc.dicing_rate = rate;
  desc.desc.dicing_length = length;
  desc.desc.offscreen_dicing_scale = 4.0f;
  scene.scene.set_mesh(1, desc.desc);
  scene.instance(1, scaling(Vec3(scale)));
  set_camera(4.0f, &scene);
  return scene.commit();
}

uint32_t triangles(const scene::Snapshot& snapshot) { return snapshot.instances[0].mesh->triangle_count; }

TEST(Dicing, ByThePicture) {
  EXPECT_EQ(triangles(*commit(2.0f, 0.0f, 12)), 2u);
  EXPECT_NEAR(triangles(*commit(0.05f, 0.0f, 3)), 2u << 6, 50);
  EXPECT_EQ(triangles(*commit(0.05f, 0.0f, 0)), 2u);
  // Squares of a twentieth of a picture make 2 · 20² triangles; divisions in half make up to twice as many.
  EXPECT_NEAR(double(triangles(*commit(0.05f, 0.0f, 12))), 1100.0, 300.0);
}

// Corners of a square that fills more than the picture are beyond its borders, but what lies in the picture is as fine
// as in a small square.
TEST(Dicing, IsAsFineInsideOfALargeMesh) {
  for (const float scale : {1.2f, 30.0f}) {
    const auto snapshot = commit(0.05f, 0.0f, 12, scale);
    const geometry::MeshData& mesh = *snapshot->instances[0].mesh;
    for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
      const auto p = geometry::triangle_positions(mesh, t);
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 a = p[k] * scale, b = p[(k + 1) % 3] * scale, middle = (a + b) * 0.5f;
        const bool is_seen = std::fabs(middle.x) < 1.0f && std::fabs(middle.y) < 1.0f;
        EXPECT_TRUE(!is_seen || glm::distance(a, b) < 0.16f);
      }
    }
    // Beyond the borders edges become longer, and 9 levels everywhere would make 2^19 triangles.
    EXPECT_LT(mesh.triangle_count, scale < 2.0f ? 2600u : 12000u);
  }
}

TEST(Dicing, ByLengthInTheSpaceOfTheMesh) { EXPECT_EQ(triangles(*commit(0.0f, 0.6f, 12, 7.0f)), 2u << 4); }

// Returns a snapshot of two instances of one mesh, far from the camera and near it.
std::shared_ptr<const scene::Snapshot> commit_two(bool near_first) {
  TestScene scene;
  MeshDesc desc(square());
  desc.desc.dicing_levels = 12;
  desc.desc.dicing_rate = 0.05f;
  scene.scene.set_mesh(1, desc.desc);
  for (const bool is_near : {near_first, !near_first}) scene.instance(1, translation(Vec3(0, 0, is_near ? 2 : -60)));
  set_camera(4.0f, &scene);
  return scene.commit();
}

TEST(Dicing, IsDecidedByTheInstanceThatNeedsMost) {
  EXPECT_EQ(triangles(*commit_two(false)), triangles(*commit_two(true)));
  EXPECT_GT(triangles(*commit_two(false)), 1000u);
}

// Dices copies of a square with limits on the number of triangles. Returns the triangles of each.
std::vector<uint32_t> dice_with_limits(const std::vector<float>& rates, const scene::DicingLimits& limits,
                                       std::vector<scene::CoarseInstance>* coarse) {
  scene::Snapshot snapshot = *commit(0.05f, 0.0f, 0);
  const geometry::InstanceData instance = snapshot.instances[0];
  snapshot.instances.clear();
  for (const float rate : rates) {
    MeshDesc desc(square());
    desc.desc.dicing_levels = 16;
    desc.desc.dicing_rate = rate;
    snapshot.instances.push_back(instance);
    snapshot.instances.back().mesh = geometry::make_mesh(desc.desc);
  }
  std::vector<scene::DicedMesh> known;
  *coarse = scene::dice_instances(CommitMonitor(nullptr, nullptr), limits, snapshot.camera, &known, &snapshot);
  std::vector<uint32_t> counts;
  for (const geometry::InstanceData& i : snapshot.instances) counts.push_back(i.mesh->triangle_count);
  return counts;
}

TEST(Dicing, KeepsWithinTheLimitOfAMesh) {
  std::vector<scene::CoarseInstance> coarse;
  const auto counts = dice_with_limits({1e-6f, 0.05f}, {10000, 1000000}, &coarse);
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_FALSE(coarse[0].by_scene);
  EXPECT_LE(counts[0], 10000u);
  EXPECT_GT(counts[0], 4000u);
  EXPECT_EQ(counts[1], triangles(*commit(0.05f, 0.0f, 16)));
}

// What the limit of the scene costs is spread over the meshes: each has edges that are about as many times too long.
TEST(Dicing, KeepsWithinTheLimitOfAScene) {
  std::vector<scene::CoarseInstance> coarse;
  const auto counts = dice_with_limits({1e-4f, 1e-4f, 1e-3f}, {10000, 12000}, &coarse);
  ASSERT_EQ(coarse.size(), 3u);
  for (const scene::CoarseInstance& instance : coarse) EXPECT_TRUE(instance.by_scene);
  EXPECT_LE(counts[0] + counts[1] + counts[2], 12000u);
  EXPECT_EQ(counts[0], counts[1]);
  EXPECT_GT(counts[0], 2000u);
  EXPECT_LT(counts[2], counts[0] / 30);
}

// Bits do not depend on threads.
TEST(Dicing, IsTheSameOnAnyNumberOfThreads) {
  const auto on = [](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([] { return diced(smooth_octahedron(), longer_than_by_place(0.02f)); });
  };
  const auto one = on(1), many = on(8);
  EXPECT_EQ(one->positions, many->positions);
  EXPECT_EQ(one->normals, many->normals);
  EXPECT_EQ(one->triangle_vertices, many->triangle_vertices);
  EXPECT_EQ(one->content_hash, many->content_hash);
}

// Edges are measured in the picture of the dicing camera, until it is removed.
TEST(Dicing, ByThePictureOfAnotherCamera) {
  TestScene scene;
  MeshDesc desc(square());
  desc.desc.dicing_levels = 12;
  desc.desc.dicing_rate = 0.05f;
  scene.scene.set_mesh(1, desc.desc);
  scene.instance(1, Mat4(1.0f));
  set_camera(8.0f, &scene);
  const uint32_t far = triangles(*scene.commit());
  GradusCamera camera = scene.commit()->camera;
  camera.matrix[14] = 4.0f;
  scene.scene.set_dicing_camera(&camera);
  const auto snapshot = scene.commit();
  EXPECT_EQ(triangles(*snapshot), triangles(*commit(0.05f, 0.0f, 12)));
  EXPECT_GT(triangles(*snapshot), 2 * far);
  scene.scene.set_dicing_camera(nullptr);
  const auto without = scene.commit();
  EXPECT_EQ(triangles(*without), far);
  EXPECT_NE(without->content_key, snapshot->content_key);
}

// Regression: no loop over the triangles of a mesh asked whether the commit is cancelled. The flag is set at some
// moments of the commit of a mesh of two million triangles, which must then end within 0.2 s of two processors.
TEST(Dicing, ACommitIsCancelledAtOnce) {
  TestScene scene;
  MeshDesc desc(square());
  desc.desc.dicing_levels = 12;
  desc.desc.dicing_length = 2e-3f;
  scene.scene.set_mesh(1, desc.desc);
  ProgramBuilder b;
  const int surface = b.add(GRADUS_OP_DIFFUSE, {In(Vec3(0.5f)), In(0.0f), In(0.0f)});
  const int noise = b.add(GRADUS_OP_DISPLACEMENT, {In(0.1f), In(0.0f), In(1.0f), In(Vec3(0.0f))}, GRADUS_NORMAL_OBJECT);
  GradusMaterial material = b.desc(surface);
  material.displacement = uint32_t(noise) + 1;
  material.displacement_method = GRADUS_DISPLACEMENT_VERTICES;
  scene.scene.set_material(1, material);
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 1);
  set_camera(4.0f, &scene);
  // Sets the flag after some seconds of the process. Returns those from then to the end, or -1 if the commit ends
  // before.
  const auto delay = [&](double seconds) {
    volatile int32_t cancel = 0;
    const uint64_t begin = process_cpu_nanoseconds();
    const auto now = [&] { return 1e-9 * double(process_cpu_nanoseconds() - begin); };
    std::atomic<bool> ended = false;
    double set = 0.0, end = 0.0;
    std::thread watch([&] {
      while (!ended && now() < seconds) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      set = now();
      cancel = 1;
    });
    try {
      scene.commit(&cancel);
      end = -1.0;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), GRADUS_ERROR_CANCELLED);
      end = now();
    }
    ended = true;
    watch.join();
    return end < 0.0 ? -1.0 : end - set;
  };
  int cancelled = 0;
  for (double seconds = 0.02; seconds < 10.0; seconds = 1.7 * seconds + 0.1) {
    const double found = delay(seconds);
    if (found < 0.0) break;
    EXPECT_LT(found, 0.4) << "after " << seconds << " s";
    ++cancelled;
  }
  EXPECT_GE(cancelled, 3);
}

// Returns a diced square, and the camera above it at a height.
class Viewport {
 public:
  explicit Viewport(float tolerance) {
    MeshDesc desc(square());
    desc.desc.dicing_levels = 12;
    desc.desc.dicing_rate = 0.05f;
    desc.desc.dicing_tolerance = tolerance;
    scene_.scene.set_mesh(1, desc.desc);
    scene_.instance(1, Mat4(1.0f));
  }

  std::shared_ptr<const scene::Snapshot> at(float height) {
    set_camera(height, &scene_);
    return scene_.commit();
  }

 private:
  TestScene scene_;
};

TEST(Dicing, ToleratesSmallMovesOfAViewport) {
  Viewport tolerant(2.0f), exact(1.0f);
  const auto first = tolerant.at(4.0f)->instances[0].mesh, second = exact.at(4.0f)->instances[0].mesh;
  EXPECT_EQ(first->triangle_count, second->triangle_count);
  EXPECT_EQ(tolerant.at(2.5f)->instances[0].mesh, first);
  EXPECT_EQ(tolerant.at(6.5f)->instances[0].mesh, first);
  EXPECT_GT(triangles(*exact.at(2.5f)), triangles(*exact.at(4.0f)));
  EXPECT_EQ(triangles(*tolerant.at(1.0f)), triangles(*exact.at(1.0f)));
  EXPECT_EQ(triangles(*tolerant.at(40.0f)), triangles(*exact.at(40.0f)));
}

// A point of the surface is found again in a frame whose camera is elsewhere and which has other triangles.
TEST(Dicing, KeepsTheMotionOfPointsForAMovingCamera) {
  Viewport view(1.0f);
  const auto from = view.at(4.0f), to = view.at(1.5f);
  ASSERT_NE(triangles(*from), triangles(*to));
  const motion::SnapshotMotion motion(*from, *to);
  geometry::Hit hit, there;
  for (uint32_t t = 0; t < triangles(*from); ++t) {
    hit.instance = 0;
    hit.primitive = t;
    hit.uv = Vec2(0.2f, 0.5f);
    ASSERT_TRUE(motion.hit(hit, &there));
    EXPECT_LT(glm::distance(from->position(hit) + from->origin, to->position(there) + to->origin), 1e-5f);
  }
}

TEST(Dicing, HasALimitWithAWarning) {
  const auto snapshot = commit(1e-6f, 0.0f, 16);
  EXPECT_LE(triangles(*snapshot), 1u << 23);
  EXPECT_GT(triangles(*snapshot), 1u << 21);
  ASSERT_EQ(snapshot->warnings.size(), 1u);
  EXPECT_NE(snapshot->warnings[0].find("coarser than its dicing rate"), std::string::npos);
  EXPECT_NE(snapshot->warnings[0].find("times as long as asked for"), std::string::npos);
  EXPECT_NE(snapshot->warnings[0].find("more than 8 million triangles"), std::string::npos);
}

}  // namespace
}  // namespace gradus::test::dicing_test
