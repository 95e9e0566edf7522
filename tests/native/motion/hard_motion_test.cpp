// Where specular motion ends: what cannot be followed is told by its cause, and nothing is ever made up (issue 7, "Bad input and hard
// cases").
#include <glm/gtc/matrix_transform.hpp>

#include "motion/motion_scene.h"

namespace gradus::test {
namespace {

class HardMotion : public MotionTest {
 protected:
  static size_t count(const ChainMotion& motion, Tracking tracking) {
    return size_t(std::count(motion.tracking.begin(), motion.tracking.end(), tracking));
  }
  // Of the pixels that show anything.
  static float tracked_share(const ChainMotion& motion, const MotionFrame* from) {
    return float(count(motion, Tracking::Tracked)) / float(from->chains.chains.size());
  }
  // Of what is tracked, how many pixels end where the way does not lead to what they show: must be none.
  static size_t wrong_ends(const ChainMotion& motion, const MotionFrame& from, const MotionFrame& to) {
    size_t wrong = 0;
    for (size_t i = 0; i < motion.film.size(); ++i) {
      if (motion.tracking[i] != Tracking::Tracked) continue;
      wrong += !shows_in(to, from, from.chains.chains[size_t(from.chains.places[i])], motion.film[i]);
    }
    return wrong;
  }
  ChainMotion checked(const MotionFrame* from, const MotionFrame* to) {
    const ChainMotion found = motion(from, to);
    expect_bounded(found);
    EXPECT_EQ(wrong_ends(found, *from, *to), 0u);
    return found;
  }
};

TEST_F(HardMotion, AFlatShadedBallIsAMirrorInEachFacet) {
  add_ball(mirror(), 8, false);
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(3, translation(Vec3(0.01f, 0.01f, 0)));
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.5f);
  EXPECT_GT(count(m, Tracking::Broken), 0u) << "facets end";
}

TEST_F(HardMotion, FacetsWhoseNormalsDisagreeWithThem) {
  add_ball(mirror(), 6, true);
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(3, translation(Vec3(0.02f, 0.01f, 0)));
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.7f);
}

TEST_F(HardMotion, AMirrorSeenEdgeOn) {
  add_room();
  scene_.quad(Vec3(-2, 0.0f, 2), Vec3(4, 0, 0), Vec3(0, 0, -4), mirror());
  scene_.camera(Vec3(0, 0.15f, 4), Vec3(0, 0, 0), 0.2f);
  const MotionFrame* a = frame("Reflection");
  EXPECT_GT(a->chains.chains.size(), 50u);
  scene_.scene.move(3, glm::rotate(Mat4(1.0f), 0.02f, Vec3(1, 0, 0)));
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.6f);
  EXPECT_GT(count(m, Tracking::Broken), 50u) << "its edge comes in between";
}

// A prism that turns until its back reflects all that it let through: beyond 41.8° within the glass.
TEST_F(HardMotion, TotalReflectionBeginsAndEnds) {
  add_room();
  const uint64_t material = clear();
  scene_.quad(Vec3(-1, -0.8f, 0.0f), Vec3(2, 0, 0), Vec3(0, 1.6f, 0), material);
  scene_.quad(Vec3(-1, -0.8f, -0.05f), Vec3(0, 1.6f, 0), Vec3(2, 0, -1.77f), material);
  scene_.camera(Vec3(0, 0.1f, 4), Vec3(0, 0, 0), 0.55f);
  const auto turn = [&](float angle) {
    for (const size_t side : {3, 4}) scene_.scene.move(side, glm::rotate(Mat4(1.0f), angle, Vec3(0, 1, 0)));
    return frame("Transmission");
  };
  const MotionFrame *through = turn(0.0f), *beyond = turn(0.15f);
  EXPECT_GT(float(through->chains.chains.size()), 1.5f * float(beyond->chains.chains.size())) << "the scene shows no total reflection";
  const ChainMotion begins = checked(through, beyond), ends = checked(beyond, through);
  EXPECT_GT(count(begins, Tracking::Broken) + count(begins, Tracking::NotConverged), 50u);
  EXPECT_EQ(count(ends, Tracking::NoPath), size_t(kSize * kSize) - beyond->chains.chains.size());
}

TEST_F(HardMotion, WhatAppearsStandsBefore) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.quad(Vec3(-1, -0.5f, 4.5f), Vec3(0, 3, 0), Vec3(2, 0, 0), grey());
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(count(m, Tracking::Occluded), 20u);
  EXPECT_EQ(count(m, Tracking::Occluded) + count(m, Tracking::Tracked), a->chains.chains.size());
}

TEST_F(HardMotion, WhatVanishesOrBecomesAnotherMeshIsGone) {
  add_ball(mirror());
  scene_.quad(Vec3(-1, -0.5f, 4.5f), Vec3(0, 3, 0), Vec3(2, 0, 0), grey());
  const MotionFrame* a = frame("Reflection");
  const size_t before = a->chains.chains.size();
  scene_.scene.mesh(901, sphere(Vec3(0, 1, 4.5f), 0.5f, 8, 16));
  scene_.scene.replace_mesh(4, 901);
  const ChainMotion changed = checked(a, frame("Reflection"));
  scene_.scene.remove_last();
  const ChainMotion vanished = checked(a, frame("Reflection"));
  for (const ChainMotion* m : {&changed, &vanished}) {
    EXPECT_GT(count(*m, Tracking::Gone), 20u);
    EXPECT_GT(count(*m, Tracking::Tracked), before / 2);
  }
}

TEST_F(HardMotion, AMirrorThatVanishesBreaksItsWays) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.scene.remove_last();
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_EQ(count(m, Tracking::Broken), a->chains.chains.size());
}

TEST_F(HardMotion, AMirrorThatBecomesAnotherMeshIsStillAMirror) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  set_sheet(&scene_, 902, {8});
  scene_.scene.replace_mesh(3, 902);
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.2f);
  EXPECT_GT(count(m, Tracking::Broken), 50u) << "where the sheet is not";
}

TEST_F(HardMotion, C8_ACutIsNoMotion) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.camera(Vec3(4, 0.5f, 0), Vec3(0, 0, 0), 0.5f);
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_EQ(count(m, Tracking::Cut), m.tracking.size());
}

TEST_F(HardMotion, WhatGoesFurtherThanTheFilmIsOutside) {
  add_room();
  scene_.quad(Vec3(-3, -0.9f, 3), Vec3(6, 0, 0), Vec3(0, 0, -6), mirror());
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, -0.9f, 0), 0.1f);
  const MotionFrame* a = frame("Reflection");
  scene_.camera(Vec3(0.0f, 0.5f, 4), Vec3(0.8f, -0.9f, 0), 0.1f);
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(count(m, Tracking::Outside), 100u);
}

TEST_F(HardMotion, BrokenGeometryIsNoTrap) {
  add_ball(mirror());
  Soup soup;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  soup.triangle(Vec3(-0.5f, 0, 1.5f), Vec3(0.5f, 0, 1.5f), Vec3(0.5f, 0, 1.5f));  // without area
  soup.triangle(Vec3(-0.2f, 0, 1.5f), Vec3(0.2f, nan, 1.5f), Vec3(0, 0.3f, 1.5f));
  soup.triangle(Vec3(-0.2f, 0.4f, 1.5f), Vec3(0.2f, 0.4f, 1.5f), Vec3(0, 0.7f, 1.5f));
  scene_.scene.mesh(903, soup);
  scene_.scene.instance(903, Mat4(1.0f), GRADUS_VISIBLE_ALL, mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(3, translation(Vec3(0.02f, 0, 0)));
  const ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.95f);
}

TEST_F(HardMotion, ACancelledSearchFindsNothing) {
  add_ball(mirror());
  const MotionFrame *a = frame("Reflection"), *b = frame("Reflection");
  const ChainMotion m = track_chains(a->chains, b->chains.tracer(), a->chains.region(), [] { return true; });
  EXPECT_EQ(count(m, Tracking::Tracked), 0u);
  expect_bounded(m);
}

// The seam of a full panorama: the shortest way is told.
TEST_F(HardMotion, APanoramaThatTurns) {
  scene_.world(Rgb(1.0f));
  scene_.ball(Vec3(0, 0, 2.5f), 1.8f, mirror(), 32, true);  // behind, where the panorama's ends meet
  scene_.camera(Vec3(0, 0, 0), Vec3(0, 0, -1), 2.0f * kPi, GRADUS_CAMERA_PANORAMA);
  scene_.camera_desc.panorama = GRADUS_PANORAMA_EQUIRECTANGULAR;
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(0, translation(Vec3(0.05f, 0.02f, 0)));
  const ChainMotion m = motion(a, frame("Reflection"));
  EXPECT_GT(count(m, Tracking::Tracked), 100u);
  for (size_t i = 0; i < m.film.size(); ++i) {
    const Vec2 centre(float(i % kSize) + 0.5f, float(i / kSize) + 0.5f);
    EXPECT_LT(glm::length(a->centres.camera.way(centre, m.film[i])), 4.0f);
  }
}

}  // namespace
}  // namespace gradus::test
