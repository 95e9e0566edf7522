// Motion of reflections and refractions from frame to frame, against brute force: a dense search of the film.
#include <glm/gtc/matrix_transform.hpp>

#include "motion/motion_scene.h"

namespace gradus::test::specular_motion_test {
namespace {

using SpecularMotion = MotionTest;

TEST_F(SpecularMotion, AStaticSceneHasExactlyZeroMotion) {
  add_room();
  scene_.quad(Vec3(-3, -0.99f, 3), Vec3(6, 0, 0), Vec3(0, 0, -6), mirror());
  scene_.ball(Vec3(0, 0, 0), 0.5f, mirror(), 32, true);
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 1.0f);
  const MotionFrame *a = frame("Reflection"), *b = frame("Reflection");
  const motion::ChainMotion m = motion(a, b);
  size_t tracked = 0, moved = 0;
  for (size_t i = 0; i < m.film.size(); ++i) {
    tracked += m.tracking[i] == motion::Tracking::Tracked;
    moved += m.film[i] != Vec2(float(i % kSize) + 0.5f, float(i / kSize) + 0.5f);
  }
  EXPECT_EQ(moved, 0u);
  EXPECT_GT(tracked, 300u);
  EXPECT_EQ(tracked, a->chains.chains.size());
}

// The image of a point in a plane mirror is the mirrored point, so that no search is needed.
TEST_F(SpecularMotion, AMovingPlaneMirrorShowsMirrorImages) {
  scene_.quad(Vec3(-2, -1, 2), Vec3(4, 0, 0), Vec3(0, 0, -4), mirror());
  scene_.quad(Vec3(-2, -1, -2), Vec3(4, 0, 0), Vec3(0, 3, 0), grey());
  scene_.camera(Vec3(0, 1.0f, 4), Vec3(0, -0.5f, 0), 1.0f);
  const motion::ChainMotion m = expect_motion("Reflection", [&](float s) {
    scene_.scene.move(0, translation(Vec3(0, 0.05f * s, 0)));
    scene_.scene.move(1, translation(s * Vec3(0.1f, 0, 0.03f)));
  });
  const MotionFrame &a = *frames_.front(), &b = *frames_.back();
  for (size_t i = 0; i < m.film.size(); ++i) {
    if (m.tracking[i] != motion::Tracking::Tracked) continue;
    const geometry::Hit& hit = a.chains.chains[size_t(a.chains.places[i])].last;
    Vec3 p = a.context.snapshot->surface_point(hit).position + Vec3(0.1f, 0, 0.03f);
    p.y = 2 * (-0.95f) - p.y;
    Vec2 film;
    ASSERT_TRUE(b.context.camera.project(p, Moment::Now, &film));
    EXPECT_LT(glm::length(film - m.film[i]), 1e-3f);
  }
}

// The closed form that the test compares with is valid for flat mirrors only.
TEST_F(SpecularMotion, TheClosedFormHoldsForFlatMirrorsOnly) {
  for (const bool flat : {true, false}) {
    add_room();
    const uint64_t material = mirror();
    const size_t number = scene_.scene.instance_count();
    if (flat)
      scene_.quad(Vec3(-1, -0.8f, 0), Vec3(2, 0, 0), Vec3(0, 2, 0.3f), material);
    else
      scene_.ball(Vec3(0, 0, 0), 0.8f, material, 48, true);
    scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
    const MotionFrame* a = frame("Reflection");
    scene_.scene.move(number, translation(Vec3(0.03f, 0.02f, 0.05f)));
    const MotionFrame* b = frame("Reflection");
    const motion::ChainMotion found = motion(a, b);
    const motion::SnapshotMotion surface(*a->context.snapshot, *b->context.snapshot);
    float worst = 0.0f;
    size_t told = 0;
    for (size_t i = 0; i < found.film.size(); ++i) {
      if (found.tracking[i] != motion::Tracking::Tracked) continue;
      Vec2 film;
      const motion::SpecularChain& chain = a->chains.chains[size_t(a->chains.places[i])];
      if (!motion::flat_mirror_motion(a->chains.tracer(), b->chains.tracer(), surface, chain,
                                      motion::FlatMirror::MovesAlong, &film))
        continue;
      ++told;
      worst = std::max(worst, glm::length(film - found.film[i]));
    }
    EXPECT_GT(told, 300u);
    if (flat) {
      EXPECT_LT(worst, 2e-3f);
    } else {
      EXPECT_GT(worst, 1.0f);
    }
    for (size_t i = scene_.scene.instance_count(); i > 0; --i) scene_.scene.remove_last();
  }
}

TEST_F(SpecularMotion, AMovingMirrorBall) {
  add_ball(mirror(), 48);
  expect_motion("Reflection", [&](float s) { scene_.scene.move(3, translation(s * Vec3(0.06f, 0.02f, 0.05f))); });
}

TEST_F(SpecularMotion, AMirrorBallSeenByAMovingCamera) {
  add_room();
  scene_.ball(Vec3(0, 0, 0), 0.8f, mirror(), 48, true);
  expect_motion("Reflection", [&](float s) {
    scene_.camera(Vec3(0.2f * s, 0.5f + 0.05f * s, 4.0f - 0.1f * s), Vec3(0, 0, 0), 0.5f);
  });
}

TEST_F(SpecularMotion, ATurningEllipsoidOfMetal) {
  add_room();
  scene_.ball(Vec3(0, 0, 0), 0.8f, scene_.material(glossy(0.2f)), 48, true);  // narrow, but no mirror
  const Mat4 shape = scaling(Vec3(1.0f, 0.5f, 0.7f));
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
  expect_motion("Reflection", [&](float s) {
    scene_.scene.move(3, glm::rotate(Mat4(1.0f), 0.05f * s, Vec3(0, 0.6f, 0.8f)) * shape);
  });
}

TEST_F(SpecularMotion, TheSkyInAMovingMirrorBall) {
  scene_.world(Rgb(1.0f));
  scene_.ball(Vec3(0, 0, 0), 0.8f, mirror(), 48, true);
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
  expect_motion("Reflection", [&](float s) { scene_.scene.move(0, translation(s * Vec3(0.06f, -0.02f, 0.1f))); });
}

TEST_F(SpecularMotion, AMirrorThatDeforms) {
  add_room();
  set_sheet(&scene_, 900, {});
  scene_.scene.instance(900, Mat4(1.0f), GRADUS_VISIBLE_ALL, mirror());
  scene_.camera(Vec3(0.5f, 0.5f, 4), Vec3(0, 0, 0), 0.6f);
  expect_motion("Reflection", [&](float s) {
    set_sheet(&scene_, 900, {48, 0.05f + 0.005f * s, 0.1f * s});
    scene_.scene.move(3, translation(s * Vec3(0.02f, 0.01f, 0)));
  });
}

TEST_F(SpecularMotion, ANormalMappedMirror) {
  add_room();
  set_sheet(&scene_, 900, {8});
  scene_.scene.instance(900, Mat4(1.0f), GRADUS_VISIBLE_ALL, normal_mapped_mirror(&scene_, 0.05f, 2.0f));
  scene_.camera(Vec3(0.5f, 0.5f, 4), Vec3(0, 0, 0), 0.6f);
  expect_motion("Reflection", [&](float s) {
    scene_.scene.move(3, glm::rotate(translation(s * Vec3(0.02f, 0.01f, 0)), 0.01f * s, Vec3(1, 0, 0)));
  });
}

TEST_F(SpecularMotion, ABumpedMirror) {
  add_room();
  set_sheet(&scene_, 900, {8, 0.0f, 0.0f, true, false});
  scene_.scene.instance(900, Mat4(1.0f), GRADUS_VISIBLE_ALL, bumped_mirror(&scene_, 0.02f));
  scene_.camera(Vec3(0.5f, 0.5f, 4), Vec3(0, 0, 0), 0.6f);
  expect_motion("Reflection", [&](float s) {
    scene_.scene.move(3, glm::rotate(translation(s * Vec3(0.02f, 0.01f, 0)), 0.01f * s, Vec3(1, 0, 0)));
  });
}

// Light is reflected around a corner by several mirrors.
TEST_F(SpecularMotion, ThreeMirrorsOneAfterTheOther) {
  components_ = lpe::ComponentSet::parse("Three=ERRRD.*L");
  add_room();
  const uint64_t material = mirror();
  scene_.quad(Vec3(-1, -0.9f, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), material);
  scene_.quad(Vec3(-1, -0.9f, -1), Vec3(0, 0, 2), Vec3(0, 2, 0), material);
  set_sheet(&scene_, 900, {48, 0.01f});
  scene_.scene.instance(900, translation(Vec3(0, 0.1f, -1)), GRADUS_VISIBLE_ALL, material);
  scene_.camera(Vec3(2.5f, 1.8f, 3.0f), Vec3(-0.6f, -0.5f, -0.6f), 0.35f);
  expect_motion("Three", [&](float s) {
    scene_.scene.move(3, translation(s * Vec3(0, 0.01f, 0)));
    scene_.scene.move(4, glm::rotate(Mat4(1.0f), 0.01f * s, Vec3(0, 1, 0)));
    scene_.scene.move(5, translation(Vec3(0.02f * s, 0.1f, -1)));
  });
}

TEST_F(SpecularMotion, AMovingGlassBall) {
  add_ball(clear(), 64);
  expect_motion("Transmission", [&](float s) { scene_.scene.move(3, translation(s * Vec3(0.03f, 0.02f, 0.02f))); });
}

TEST_F(SpecularMotion, AGlassSlabThatTurns) {
  add_room();
  const uint64_t material = clear();
  scene_.quad(Vec3(-1, -0.8f, 0.1f), Vec3(2, 0, 0), Vec3(0, 1.8f, 0), material);
  scene_.quad(Vec3(-1, -0.8f, -0.1f), Vec3(0, 1.8f, 0), Vec3(2, 0, 0), material);
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.6f);
  expect_motion("Transmission", [&](float s) {
    for (const size_t side : {3, 4})
      scene_.scene.move(side, glm::rotate(translation(Vec3(0.03f * s, 0, 0)), 0.08f * s, Vec3(0, 1, 0)));
  });
}

// Eight refractions: through four balls behind one another.
TEST_F(SpecularMotion, FourGlassBallsInARow) {
  components_ = lpe::ComponentSet::parse("Four=ETTTTTTTTD.*L");
  add_room();
  Surface weak = glass(0.0f);
  weak.ior = 1.1f;
  const uint64_t material = scene_.material(weak);
  for (int i = 0; i < 4; ++i) scene_.ball(Vec3(0.02f * float(i), 0, 0.6f - 0.7f * float(i)), 0.3f, material, 48, true);
  scene_.camera(Vec3(0, 0.0f, 3), Vec3(0, 0, 0), 0.3f);
  expect_motion("Four", [&](float s) {
    for (size_t i = 3; i < 7; ++i) scene_.scene.move(i, translation(s * Vec3(0.004f * float(i), -0.005f, 0.01f)));
  });
}

// The vectors of a blurred picture refer to the times of the frames.
TEST_F(SpecularMotion, MotionBlurDoesNotChangeIt) {
  std::array<motion::ChainMotion, 2> found;
  for (const bool blurred : {false, true}) {
    PathScene scene;
    const uint64_t material = scene.material(glossy(0.0f));
    const auto ball_at = [&](const Vec3& at) {
      if (blurred)
        scene.scene.shutter_poses = {translation(Vec3(-0.05f, 0, 0)), Mat4(1.0f), translation(Vec3(0.05f, 0.02f, 0))};
      scene.place = translation(at);
      scene.ball(Vec3(0.0f), 0.6f, material, 32, true);
      scene.place = Mat4(1.0f);
      scene.scene.shutter_poses.clear();
    };
    scene.world(Rgb(1.0f));
    scene.quad(Vec3(-6, -1, 6), Vec3(12, 0, 0), Vec3(0, 0, -10), scene.material(matte(Rgb(0.5f))));
    if (blurred) scene.open_shutter({}, {translation(Vec3(-0.05f, 0, 0)), Mat4(1.0f), translation(Vec3(0.05f, 0, 0))});
    ball_at(Vec3(0));
    scene.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
    const auto a = motion_frame(scene.context(test_settings(kSize, kSize)), components_, "Reflection");
    scene.scene.remove_last();
    ball_at(Vec3(0.06f, 0.02f, 0.05f));
    const auto b = motion_frame(scene.context(test_settings(kSize, kSize)), components_, "Reflection");
    found[blurred] = motion(a.get(), b.get());
  }
  size_t both = 0;
  for (size_t i = 0; i < found[0].film.size(); ++i) {
    if (found[0].tracking[i] != motion::Tracking::Tracked || found[1].tracking[i] != motion::Tracking::Tracked)
      continue;
    ++both;
    EXPECT_LT(glm::length(found[0].film[i] - found[1].film[i]), 0.01f) << i;
  }
  EXPECT_GT(both, 400u);
}

}  // namespace
}  // namespace gradus::test::specular_motion_test
