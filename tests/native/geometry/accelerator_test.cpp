// Static geometry is built once and shared by the snapshots; moving geometry is kept beside it, and rays meet both.
#include <algorithm>
#include <ostream>

#include <gtest/gtest.h>

#include "geometry/accelerator.h"
#include "geometry/rays4.h"
#include "scene/scene_fixture.h"

namespace gradus::test::accelerator_test {

namespace {

constexpr int kSoupSide = 400;  // 2 · 400² triangles: more than the limit for keeping static geometry

struct Queries {
  std::vector<Ray> rays;
  explicit Queries(int count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-6.0f, 6.0f);
    for (int i = 0; i < count; ++i) {
      const Vec3 origin(place(random), place(random), place(random));
      const float t_max = i % 3 ? kInfinity : 4.0f;
      const float time = float(i % 16) / 16.0f;
      rays.push_back({origin, 0.0f, random_direction(random), t_max, time});
    }
  }
};

struct Answer {
  bool hit = false, blocked = false;
  float t = 0.0f;
  uint32_t instance = 0, triangle = 0;
  Vec3 position{0.0f};
  bool operator==(const Answer&) const = default;
};

std::vector<Answer> ask(const scene::Snapshot& snapshot, const Queries& queries) {
  std::vector<Answer> answers;
  for (const Ray& ray : queries.rays) {
    geometry::Hit hit;
    Answer& a = answers.emplace_back();
    a.hit = snapshot.intersect(ray, GRADUS_VISIBLE_CAMERA, &hit);
    a.blocked = snapshot.occluded(ray);
    a.t = hit.t, a.instance = hit.instance, a.triangle = hit.primitive;
    if (a.hit) a.position = snapshot.surface_point(hit).position;
  }
  return answers;
}

// Expects packets of four rays to give the same answers as single rays.
void expect_packets_agree(const scene::Snapshot& snapshot, const Queries& queries, const std::vector<Answer>& answers) {
  for (size_t i = 0; i + 4 <= queries.rays.size(); i += 4) {
    geometry::Hit hits[4];
    snapshot.intersect4(&queries.rays[i], GRADUS_VISIBLE_CAMERA, hits);
    geometry::Rays4 rays{};
    rays.time = queries.rays[i].time;
    const bool wanted[4] = {true, true, true, true};
    bool blocked[4];
    for (int k = 0; k < 4; ++k) {
      const Ray& ray = queries.rays[i + size_t(k)];
      EXPECT_EQ(hits[k].valid(), answers[i + size_t(k)].hit);
      EXPECT_EQ(hits[k].instance, answers[i + size_t(k)].instance);
      geometry::set_lane(k, ray.origin, &rays.origin);
      geometry::set_lane(k, ray.direction, &rays.direction);
      rays.t_max[k] = ray.t_max;
    }
    snapshot.occluded4(rays, wanted, blocked);
    for (int k = 0; k < 4; ++k) {
      Ray ray = queries.rays[i + size_t(k)];
      ray.time = rays.time;
      EXPECT_EQ(blocked[k], snapshot.occluded(ray));
    }
  }
}

// Builds a room with a ball in it.
void build_room(TestScene* scene, int side) {
  scene->mesh(1, sphere(Vec3(0.0f), 8.0f, side, side));
  scene->mesh(2, sphere(Vec3(0.0f), 1.0f, 20, 20));
  scene->instance(1);
  scene->instance(2, translation(Vec3(1, 2, 0)));
}

bool holds(const geometry::Accelerator& accelerator, const geometry::GeometryGroup* group) {
  return accelerator.static_part.group.get() == group || accelerator.moving.group.get() == group;
}

// Counts the triangles in the top levels of `now` that those of `before` do not share.
uint64_t built_triangles(const geometry::Accelerator& now, const geometry::Accelerator& before) {
  uint64_t sum = 0;
  for (const auto* group : {now.static_part.group.get(), now.moving.group.get()}) {
    if (!group || holds(before, group)) continue;
    for (const auto& mesh : group->meshes) sum += mesh->triangle_count;
  }
  return sum;
}

// Frames without motion data: a room, a ball that is marked as possibly moving and does move, and the objects that
// `show` adds.
constexpr uint32_t kMayMove = GRADUS_VISIBLE_ALL | GRADUS_MAY_MOVE;

struct Hints {
  const char* name;
  void (*show)(TestScene* scene, int frame);
};

std::shared_ptr<const scene::Snapshot> show_frame(TestScene* scene, int frame, const Hints& hints) {
  while (scene->instance_count() > 0) scene->remove_last();
  scene->mesh(2, sphere(Vec3(0.0f), 1.0f, 20, 20));
  scene->instance(1);
  scene->instance(2, translation(Vec3(float(frame), 2, 0)), kMayMove);
  hints.show(scene, frame);
  return scene->commit();
}

void PrintTo(const Hints& hints, std::ostream* out) { *out << hints.name; }

class AcceleratorHints : public testing::TestWithParam<Hints> {};

TEST(Accelerator, StaticGeometryIsBuiltOnceAndSharedByTheFrames) {
  TestScene scene;
  build_room(&scene, kSoupSide);
  std::weak_ptr<const geometry::GeometryGroup> static_part, moving;
  for (int frame = 1; frame < 5; ++frame) {
    scene.matrices_before = {Mat4(1.0f), translation(Vec3(float(frame - 1), 2, 0))};
    scene.move(1, translation(Vec3(float(frame), 2, 0)));
    const auto snapshot = scene.commit();
    const geometry::Accelerator& built = *snapshot->accelerator;
    ASSERT_TRUE(built.moving.group);
    EXPECT_EQ(built.static_part.instances, std::vector<uint32_t>{0});
    EXPECT_EQ(built.moving.instances, std::vector<uint32_t>{1});
    if (frame > 1) {
      EXPECT_EQ(built.static_part.group, static_part.lock());
    }
    EXPECT_NE(built.moving.group, moving.lock());
    static_part = built.static_part.group;
    moving = built.moving.group;
    geometry::Hit hit;
    ASSERT_TRUE(
        snapshot->intersect({Vec3(float(frame), 2, 5), 0.0f, Vec3(0, 0, -1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
    EXPECT_EQ(hit.instance, 1u);
    EXPECT_NEAR(hit.t, 4.0f, 1e-3f);
  }
}

TEST(Accelerator, RaysMeetStaticAndMovingGeometry) {
  const Queries queries(20000);
  TestScene together, apart;
  for (TestScene* scene : {&together, &apart}) {
    build_room(scene, kSoupSide);
    scene->instance(2, translation(Vec3(-3, 0, 2)), GRADUS_VISIBLE_CAMERA | GRADUS_VISIBLE_DIFFUSE);  // casts no shadow
  }
  apart.matrices_before = {Mat4(1.0f), translation(Vec3(2, 2, 0)), translation(Vec3(-3, 0, 3))};
  const auto one = together.commit(), two = apart.commit();
  ASSERT_FALSE(one->accelerator->moving.group);
  ASSERT_TRUE(two->accelerator->moving.group);
  const std::vector<Answer> expected = ask(*one, queries), found = ask(*two, queries);
  EXPECT_GT(std::count_if(found.begin(), found.end(), [](const Answer& a) { return a.hit && a.instance > 0; }), 200);
  EXPECT_EQ(expected, found);
  expect_packets_agree(*two, queries, found);
}

TEST(Accelerator, BlurredInstancesLieBesideASmallScene) {
  const Queries queries(20000);
  TestScene scene;
  build_room(&scene, 12);
  scene.shutter_poses = {translation(Vec3(-1, 0, 0)), translation(Vec3(1, 0, 0))};
  scene.instance(2, translation(Vec3(0, -3, 0)));
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->accelerator->moving.instances, std::vector<uint32_t>{2});
  const std::vector<Answer> found = ask(*snapshot, queries);
  EXPECT_GT(std::count_if(found.begin(), found.end(), [](const Answer& a) { return a.hit && a.instance == 2; }), 100);
  expect_packets_agree(*snapshot, queries, found);
  // The ball at each time, as a static instance with the pose of that time.
  TestScene still;
  build_room(&still, 12);
  still.instance(2);
  for (const float time : {0.0f, 0.25f, 0.5f, 1.0f}) {
    still.move(2, translation(Vec3(2.0f * time - 1.0f, -3, 0)));
    const auto moment = still.commit();
    for (Ray ray : queries.rays) {
      ray.time = time;
      geometry::Hit a, b;
      moment->intersect(ray, GRADUS_VISIBLE_CAMERA, &a);
      snapshot->intersect(ray, GRADUS_VISIBLE_CAMERA, &b);
      if (a.instance == 2 || b.instance == 2) {
        EXPECT_NEAR(a.t, b.t, 0.02f);
      }
    }
  }
}

TEST(Accelerator, GeometryThatMayMoveIsKeptBesideALargeStaticScene) {
  for (const int side : {12, kSoupSide}) {
    TestScene scene;
    build_room(&scene, side);
    scene.instance(2, translation(Vec3(0, -3, 0)), GRADUS_VISIBLE_ALL | GRADUS_MAY_MOVE);
    const auto snapshot = scene.commit();
    const std::vector<uint32_t> moving = side == kSoupSide ? std::vector<uint32_t>{2} : std::vector<uint32_t>{};
    EXPECT_EQ(snapshot->accelerator->moving.instances, moving);
    geometry::Hit hit;
    ASSERT_TRUE(snapshot->intersect({Vec3(0, -3, 5), 0.0f, Vec3(0, 0, -1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
    EXPECT_EQ(hit.instance, 2u);
    EXPECT_TRUE(snapshot->occluded({Vec3(0, -3, 5), 0.0f, Vec3(0, 0, -1), 6.0f}));
  }
}

TEST(Accelerator, FramesWithoutMotionDataBuildOnlyWhatIsMarkedAsMoving) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 8.0f, kSoupSide, kSoupSide));
  const Hints told{"", [](TestScene*, int) {}};
  auto before = show_frame(&scene, 1, told);
  const uint64_t ball = before->instances[1].mesh->triangle_count, room = before->instances[0].mesh->triangle_count;
  EXPECT_EQ(built_triangles(*before->accelerator, {}), room + ball);
  for (int frame = 2; frame < 5; ++frame) {
    const auto now = show_frame(&scene, frame, told);
    EXPECT_EQ(built_triangles(*now->accelerator, *before->accelerator), ball);
    before = now;
  }
  scene.move(1, translation(Vec3(-3, 0, 0)));
  EXPECT_EQ(built_triangles(*scene.commit()->accelerator, *before->accelerator), ball);
}

TEST_P(AcceleratorHints, WrongHintsCostOnlyTime) {
  const Queries queries(3000);
  const Soup room = sphere(Vec3(0.0f), 8.0f, kSoupSide, kSoupSide);
  TestScene scene;
  scene.mesh(1, room);
  std::vector<std::vector<Answer>> seen;
  for (int frame = 1; frame < 4; ++frame) {
    TestScene alone;
    alone.mesh(1, room);
    const auto snapshot = show_frame(&scene, frame, GetParam());
    seen.push_back(ask(*snapshot, queries));
    EXPECT_EQ(seen.back(), ask(*show_frame(&alone, frame, GetParam()), queries)) << "frame " << frame;
    expect_packets_agree(*snapshot, queries, seen.back());
  }
  EXPECT_TRUE(seen[0] != seen[1] && seen[1] != seen[2]) << "the test says something";
}

constexpr uint32_t kFixed = GRADUS_VISIBLE_ALL;

INSTANTIATE_TEST_SUITE_P(
    All, AcceleratorHints,
    testing::Values(Hints{"MovesUntold",
                          [](TestScene* scene, int frame) {
                            scene->instance(2, translation(Vec3(-3, float(frame), 0)), kFixed);
                          }},
                    Hints{"DeformsUntold",
                          [](TestScene* scene, int frame) {
                            scene->mesh(3, sphere(Vec3(0.0f), 0.5f + 0.25f * float(frame), 20, 20));
                            scene->instance(3, translation(Vec3(-3, 0, 0)), kFixed);
                          }},
                    Hints{"AppearsUntold",
                          [](TestScene* scene, int frame) {
                            if (frame > 1) scene->instance(2, translation(Vec3(-3, 0, 0)), kFixed);
                          }},
                    Hints{"VanishesUntold",
                          [](TestScene* scene, int frame) {
                            if (frame < 3) scene->instance(2, translation(Vec3(-3, 0, 0)), kFixed);
                          }},
                    Hints{"IsHiddenUntold",
                          [](TestScene* scene, int frame) {
                            scene->instance(2, translation(Vec3(-3, 0, 0)),
                                            frame == 2 ? kFixed & ~uint32_t(GRADUS_VISIBLE_CAMERA) : kFixed);
                          }},
                    Hints{"RestsThoughTold",
                          [](TestScene* scene, int) { scene->instance(2, translation(Vec3(-3, 0, 0)), kMayMove); }},
                    Hints{"IsToldNowAndThen",
                          [](TestScene* scene, int frame) {
                            scene->instance(2, translation(Vec3(-3, float(frame / 2), 0)),
                                            frame == 2 ? kMayMove : kFixed);
                          }}),
    [](const testing::TestParamInfo<Hints>& info) { return std::string(info.param.name); });

TEST(Accelerator, SnapshotsStayValidAfterLaterOnes) {
  const Queries queries(5000);
  TestScene scene;
  build_room(&scene, 40);
  scene.shutter_poses = {translation(Vec3(-1, 0, 0)), translation(Vec3(1, 0, 0))};
  scene.instance(2, translation(Vec3(0, -3, 0)));
  const auto first = scene.commit();
  const std::vector<Answer> before = ask(*first, queries);
  for (int frame = 1; frame < 4; ++frame) {
    scene.mesh(2, sphere(Vec3(0.0f), 1.0f + 0.1f * float(frame), 20, 20));
    scene.move(1, translation(Vec3(float(frame), 2, 0)));
    EXPECT_NE(ask(*scene.commit(), queries), before);
  }
  EXPECT_EQ(ask(*first, queries), before);
}

TEST(Accelerator, TheSameListIsSharedWhenOnlyPosesChange) {
  const Queries queries(5000);
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 8.0f, 12, 12));
  scene.mesh(2, sphere(Vec3(0.0f), 1.0f, 20, 20));
  const auto show = [&](int movers) {
    while (scene.instance_count() > 0) scene.remove_last();
    scene.shutter_poses = {translation(Vec3(-1, 0, 0)), translation(Vec3(1, 0, 0))};
    for (int i = 0; i < movers; ++i) scene.instance(2, translation(Vec3(float(2 * i), -3, 0)));
    scene.shutter_poses.clear();
    scene.instance(1);
    return scene.commit();
  };
  const auto first = show(1);
  const auto second = show(3);
  EXPECT_EQ(first->accelerator->static_part.group, second->accelerator->static_part.group);
  EXPECT_EQ(second->accelerator->static_part.instances, std::vector<uint32_t>{3});
  for (const Answer& a : ask(*second, queries)) EXPECT_LT(a.hit ? a.instance : 0, 4u);
  geometry::Hit hit;
  ASSERT_TRUE(second->intersect({Vec3(0, 0, 0), 0.0f, Vec3(0, 0, 1), kInfinity, 0.5f}, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_EQ(hit.instance, 3u);
  ASSERT_TRUE(first->intersect({Vec3(0, 0, 0), 0.0f, Vec3(0, 0, 1), kInfinity, 0.5f}, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_EQ(hit.instance, 1u);
}

TEST(Accelerator, StillsAndScenesInWhichAllMovesAreOneGroup) {
  TestScene scene;
  build_room(&scene, 12);
  EXPECT_FALSE(scene.commit()->accelerator->moving.group);
  scene.matrices_before = {translation(Vec3(1, 0, 0)), translation(Vec3(1, 0, 0))};
  EXPECT_FALSE(scene.commit()->accelerator->moving.group);
  scene.matrices_before = {Mat4(1.0f), translation(Vec3(1, 0, 0))};
  EXPECT_FALSE(scene.commit()->accelerator->moving.group) << "too little is static to be worth it";
}

TEST(Accelerator, AChangeOfStaticGeometryIsNoticed) {
  TestScene scene;
  build_room(&scene, 12);
  scene.shutter_poses = {translation(Vec3(-1, 0, 0)), translation(Vec3(1, 0, 0))};
  scene.instance(2, translation(Vec3(0, -3, 0)));
  const auto first = scene.commit();
  scene.mesh(1, sphere(Vec3(0.0f), 6.0f, 12, 12));
  const auto second = scene.commit();
  EXPECT_NE(first->accelerator->static_part.group, second->accelerator->static_part.group);
  EXPECT_EQ(first->accelerator->moving.group, second->accelerator->moving.group);
  geometry::Hit hit;
  ASSERT_TRUE(second->intersect({Vec3(0, 0, 0), 0.0f, Vec3(0, 0, 1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_NEAR(hit.t, 6.0f, 1e-3f);
}

TEST(RayBox, NeverMissesARayThatMeetsIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (int i = 0; i < 200000; ++i) {
    const float size = std::pow(10.0f, 4.0f * unit(random)), far = std::pow(10.0f, 3.0f * unit(random));
    const Vec3 centre = Vec3(unit(random), unit(random), unit(random)) * far;
    geometry::RayBox box;
    box.add(centre - size, centre + size);
    box.widen();
    // A ray from anywhere to a point of the box; some directions are parallel to an axis.
    Vec3 origin = Vec3(unit(random), unit(random), unit(random)) * 10.0f * far;
    const Vec3 target = centre + Vec3(unit(random), unit(random), unit(random)) * size;
    if (i % 4 == 0) origin[i % 3] = target[i % 3];
    const Vec3 line = target - origin;
    const float length = glm::length(line);
    if (length == 0.0f) continue;
    EXPECT_TRUE(box.may_meet(origin, line / length, 0.0f, length * 1.001f));
    EXPECT_TRUE(box.may_meet(origin, line / length, 0.0f, kInfinity));
  }
  geometry::RayBox box;
  box.add(Vec3(-1.0f), Vec3(1.0f));
  box.widen();
  EXPECT_FALSE(box.may_meet(Vec3(0, 0, 5), Vec3(0, 0, 1), 0.0f, kInfinity));
  EXPECT_FALSE(box.may_meet(Vec3(0, 0, 5), Vec3(0, 0, -1), 0.0f, 3.0f));
  EXPECT_FALSE(box.may_meet(Vec3(2, 0, 5), Vec3(0, 0, -1), 0.0f, kInfinity));
  EXPECT_FALSE(box.may_meet(Vec3(0, 0, 5), Vec3(0, 0, -1), 0.0f, -kInfinity)) << "an occluded ray";
}

}  // namespace
}  // namespace gradus::test::accelerator_test
