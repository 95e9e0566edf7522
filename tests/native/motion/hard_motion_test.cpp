// Limits of specular motion: chains that cannot be followed are reported with their cause, and no vector is invented.
#include <glm/gtc/matrix_transform.hpp>

#include "motion/motion_scene.h"

namespace gradus::test::hard_motion_test {
namespace {

class HardMotion : public MotionTest {
 protected:
  static size_t count(const motion::ChainMotion& motion, motion::Tracking tracking) {
    return size_t(std::count(motion.tracking.begin(), motion.tracking.end(), tracking));
  }
  // Returns the tracked share of the pixels that have a chain.
  static float tracked_share(const motion::ChainMotion& motion, const MotionFrame* from) {
    return float(count(motion, motion::Tracking::Tracked)) / float(from->chains.chains.size());
  }
  // Returns the number of tracked pixels whose vectors do not end where the object is visible; it must be 0.
  static size_t wrong_ends(const motion::ChainMotion& motion, const MotionFrame& from, const MotionFrame& to) {
    size_t wrong = 0;
    for (size_t i = 0; i < motion.film.size(); ++i) {
      if (motion.tracking[i] != motion::Tracking::Tracked) continue;
      wrong += !shows_in(to, from, from.chains.chains[size_t(from.chains.places[i])], motion.film[i]);
    }
    return wrong;
  }
  motion::ChainMotion checked(const MotionFrame* from, const MotionFrame* to) {
    const motion::ChainMotion found = motion(from, to);
    expect_bounded(found);
    EXPECT_EQ(wrong_ends(found, *from, *to), 0u);
    return found;
  }
};

TEST_F(HardMotion, AFlatShadedBallIsAMirrorInEachFacet) {
  add_ball(mirror(), 8, false);
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(3, translation(Vec3(0.01f, 0.01f, 0)));
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.5f);
  EXPECT_GT(count(m, motion::Tracking::Broken), 0u) << "facets end";
}

TEST_F(HardMotion, FacetsWhoseNormalsDisagreeWithThem) {
  add_ball(mirror(), 6, true);
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(3, translation(Vec3(0.02f, 0.01f, 0)));
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.7f);
}

TEST_F(HardMotion, AMirrorSeenEdgeOn) {
  add_room();
  scene_.quad(Vec3(-2, 0.0f, 2), Vec3(4, 0, 0), Vec3(0, 0, -4), mirror());
  scene_.camera(Vec3(0, 0.15f, 4), Vec3(0, 0, 0), 0.2f);
  const MotionFrame* a = frame("Reflection");
  EXPECT_GT(a->chains.chains.size(), 50u);
  scene_.scene.move(3, glm::rotate(Mat4(1.0f), 0.02f, Vec3(1, 0, 0)));
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.6f);
  EXPECT_GT(count(m, motion::Tracking::Broken), 50u) << "its edge comes in between";
}

// A prism that rotates until its back reflects totally: beyond 41.8° within the glass.
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
  EXPECT_GT(float(through->chains.chains.size()), 1.5f * float(beyond->chains.chains.size()))
      << "the scene shows no total reflection";
  const motion::ChainMotion begins = checked(through, beyond), ends = checked(beyond, through);
  EXPECT_GT(count(begins, motion::Tracking::Broken) + count(begins, motion::Tracking::NotConverged), 50u);
  EXPECT_EQ(count(ends, motion::Tracking::NoPath), size_t(kSize * kSize) - beyond->chains.chains.size());
}

TEST_F(HardMotion, WhatAppearsIsInFront) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.quad(Vec3(-1, -0.5f, 4.5f), Vec3(0, 3, 0), Vec3(2, 0, 0), grey());
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(count(m, motion::Tracking::Occluded), 20u);
  EXPECT_EQ(count(m, motion::Tracking::Occluded) + count(m, motion::Tracking::Tracked), a->chains.chains.size());
}

TEST_F(HardMotion, ObjectsThatVanishOrBecomeAnotherMeshAreGone) {
  add_ball(mirror());
  scene_.quad(Vec3(-1, -0.5f, 4.5f), Vec3(0, 3, 0), Vec3(2, 0, 0), grey());
  const MotionFrame* a = frame("Reflection");
  const size_t before = a->chains.chains.size();
  scene_.scene.mesh(901, sphere(Vec3(0, 1, 4.5f), 0.5f, 8, 16));
  scene_.scene.replace_mesh(4, 901);
  const motion::ChainMotion changed = checked(a, frame("Reflection"));
  scene_.scene.remove_last();
  const motion::ChainMotion vanished = checked(a, frame("Reflection"));
  for (const motion::ChainMotion* m : {&changed, &vanished}) {
    EXPECT_GT(count(*m, motion::Tracking::Gone), 20u);
    EXPECT_GT(count(*m, motion::Tracking::Tracked), before / 2);
  }
}

TEST_F(HardMotion, AMirrorThatVanishesEndsItsChains) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.scene.remove_last();
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_EQ(count(m, motion::Tracking::Broken), a->chains.chains.size());
}

TEST_F(HardMotion, AMirrorThatBecomesAnotherMeshIsStillAMirror) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  set_sheet(&scene_, 902, {8});
  scene_.scene.replace_mesh(3, 902);
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.2f);
  EXPECT_GT(count(m, motion::Tracking::Broken), 50u) << "where the sheet is not";
}

TEST_F(HardMotion, C8_AShotChangeIsNoMotion) {
  add_ball(mirror());
  const MotionFrame* a = frame("Reflection");
  scene_.camera(Vec3(4, 0.5f, 0), Vec3(0, 0, 0), 0.5f);
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_EQ(count(m, motion::Tracking::ShotChange), m.tracking.size());
}

TEST_F(HardMotion, MotionBeyondTheFilmIsOutside) {
  add_room();
  scene_.quad(Vec3(-3, -0.9f, 3), Vec3(6, 0, 0), Vec3(0, 0, -6), mirror());
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, -0.9f, 0), 0.1f);
  const MotionFrame* a = frame("Reflection");
  scene_.camera(Vec3(0.0f, 0.5f, 4), Vec3(0.8f, -0.9f, 0), 0.1f);
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(count(m, motion::Tracking::Outside), 100u);
}

TEST_F(HardMotion, InvalidGeometryIsHandled) {
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
  const motion::ChainMotion m = checked(a, frame("Reflection"));
  EXPECT_GT(tracked_share(m, a), 0.95f);
}

TEST_F(HardMotion, ACancelledSearchFindsNothing) {
  add_ball(mirror());
  const MotionFrame *a = frame("Reflection"), *b = frame("Reflection");
  const motion::ChainMotion m =
      motion::track_chains(a->chains, b->chains.tracer(), a->chains.region(), [] { return true; });
  EXPECT_EQ(count(m, motion::Tracking::Tracked), 0u);
  expect_bounded(m);
}

// A full panorama with a mirror ball behind the camera, where the two ends of the film meet.
class PanoramaMotion : public HardMotion {
 protected:
  static constexpr int kWidth = 64, kSeam = 2;  // in pixels: width of the film, and of the columns at either end

  std::vector<const MotionFrame*> ball_goes(const Vec3& path, int steps) {
    scene_.world(Rgb(1.0f));
    scene_.ball(Vec3(0, 0, 2.5f), 1.8f, mirror(), 32, true);
    scene_.camera(Vec3(0, 0, 0), Vec3(0, 0, -1), 2.0f * kPi, GRADUS_CAMERA_PANORAMA);
    scene_.camera_desc.panorama = GRADUS_PANORAMA_EQUIRECTANGULAR;
    std::vector<const MotionFrame*> frames;
    for (int k = 0; k <= steps; ++k) {
      scene_.scene.move(0, translation(float(k) / float(steps) * path));
      frames_.push_back(motion_frame(scene_.context(test_settings(kWidth, kWidth / 2)), components_, "Reflection"));
      frames.push_back(frames_.back().get());
    }
    return frames;
  }
};

// Motion from one end of the film to the other ends on the film, and takes the shorter direction.
TEST_F(PanoramaMotion, ItsSeamIsNoEdge) {
  const std::vector<const MotionFrame*> frames = ball_goes(Vec3(0.2f, 0.08f, 0), 16);
  const MotionFrame &first = *frames.front(), &last = *frames.back();
  std::vector<motion::ChainTracer> tracers;
  for (const MotionFrame* frame : frames) tracers.push_back(frame->chains.tracer());
  std::vector<const motion::ChainTracer*> path;
  for (const motion::ChainTracer& tracer : tracers) path.push_back(&tracer);
  const motion::ChainMotion m = motion(&first, &last);
  size_t at_seam = 0, crossed = 0;
  for (size_t i = 0; i < m.film.size(); ++i) {
    const auto x = int(i % kWidth);
    if (first.chains.places[i] < 0 || std::min(x, kWidth - 1 - x) >= kSeam) continue;
    const Vec2 centre(float(x) + 0.5f, float(i / kWidth) + 0.5f);
    glm::dvec2 truth;
    ASSERT_TRUE(motion::true_place(path, first.chains.chains[size_t(first.chains.places[i])], centre, &truth)) << x;
    ASSERT_EQ(m.tracking[i], motion::Tracking::Tracked) << x;
    EXPECT_TRUE(m.film[i].x >= 0.0f && m.film[i].x < float(kWidth)) << x << ' ' << m.film[i].x;
    EXPECT_LT(glm::length(last.centres.camera.film_displacement(Vec2(truth), m.film[i])), 0.1f) << x;
    EXPECT_LT(glm::length(last.centres.camera.film_displacement(centre, m.film[i])), 4.0f) << x;
    ++at_seam;
    crossed += std::fabs(m.film[i].x - centre.x) > 0.5f * float(kWidth);
  }
  EXPECT_GT(at_seam, 50u);
  EXPECT_GT(crossed, 10u);
}

}  // namespace
}  // namespace gradus::test::hard_motion_test
