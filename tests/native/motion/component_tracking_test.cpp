// Displacements of components between two frames of a job: found in bands, they are those of the whole film, and
// nothing is searched in a static scene.
#include "motion/component_tracking.h"

#include <optional>

#include <gtest/gtest.h>

#include "motion/motion_scene.h"

namespace gradus::test::component_tracking_test {
namespace {

// The film is higher than a band.
constexpr uint32_t kWidth = 48, kHeight = 140;

class ComponentTracking : public MotionTest {
 protected:
  std::unique_ptr<MotionFrame> seen() {
    return motion_frame(scene_.context(test_settings(kWidth, kHeight)), components_, "Reflection");
  }
  // Compares with the chains of all pixels, each of which is searched.
  void expect_tracked_components(const MotionFrame& from, const MotionFrame& to) {
    const motion::ChainTracer there = to.chains.tracer();
    const motion::ChainMotion found = motion::track_components(from.centres, there, components_,
                                                               1u << components_.find("Reflection"), kNever)
                                          .at(0),
                              expected = motion::track_chains(from.chains, there, from.chains.region());
    ASSERT_EQ(found.film.size(), size_t(kWidth) * kHeight);
    for (size_t i = 0; i < found.film.size(); ++i) {
      const int32_t place = from.chains.places[i];
      const bool is_seen_through = place >= 0 && from.chains.chains[size_t(place)].signature.length > 0;
      ASSERT_EQ(found.tracking[i], is_seen_through ? expected.tracking[i] : motion::Tracking::NoPath) << i;
      if (found.tracking[i] != motion::Tracking::Tracked) continue;
      ++tracked_;
      moving_ += found.film[i] != path::pixel_centre(int32_t(i % kWidth), int32_t(i / kWidth)) ? 1 : 0;
      ASSERT_NEAR(found.film[i].x, expected.film[i].x, 2e-3f);
      ASSERT_NEAR(found.film[i].y, expected.film[i].y, 2e-3f);
    }
  }

  const CancelCheck kNever = [] { return false; };
  size_t tracked_ = 0, moving_ = 0;
};

TEST_F(ComponentTracking, InBandsIsThatOfTheWholeFilm) {
  add_ball(mirror());
  const auto from = seen();
  scene_.scene.move(3, translation(Vec3(0.02f, 0.03f, 0)));
  expect_tracked_components(*from, *seen());
  EXPECT_GT(tracked_, 500u);
  EXPECT_GT(moving_, 400u);
}

// Materials and instances of a job's frames are different objects even if nothing has changed.
TEST_F(ComponentTracking, OfAStaticSceneIsZero) {
  add_ball(mirror());
  const auto from = seen();
  const auto to = seen();
  const motion::Change change = [&] {
    motion::Change made(*from->context.snapshot);
    made.add(*to->context.snapshot);
    return made;
  }();
  EXPECT_FALSE(change.of_all());
  for (uint32_t i = 0; i < from->context.snapshot->instances.size(); ++i) EXPECT_FALSE(change.of_instance(i));
  expect_tracked_components(*from, *to);
  EXPECT_GT(tracked_, 500u);
  EXPECT_EQ(moving_, 0u);
}

// The ball is static, but its reflection moves.
TEST_F(ComponentTracking, OfAMirrorWhoseBumpChangesMoves) {
  const uint64_t smooth = mirror();
  add_ball(smooth);
  const auto from = seen();
  const uint64_t bumped = bumped_mirror(&scene_, 0.01f);
  scene_.scene.dress(3, bumped);
  expect_tracked_components(*from, *seen());
  EXPECT_GT(moving_, 100u);
}

// What a pixel mainly shows is seen in a surface that does little else than reflect, and directly on others, though
// reflections are seen in both.
TEST_F(ComponentTracking, OfTheDominantFollowsReflectionsInMirrorsAlone) {
  add_ball(mirror());
  for (const float diffuse : {0.0f, 0.1f, 0.3f, 0.7f}) {
    Surface surface = glossy(0.0f);
    surface.glossy = Rgb(0.8f - diffuse);
    surface.diffuse = Rgb(diffuse);
    scene_.scene.dress(3, scene_.material(surface));
    scene_.scene.move(3, translation(Vec3(0.0f)));
    const auto from = seen();
    scene_.scene.move(3, translation(Vec3(0.02f, 0.03f, 0)));
    const auto to = seen();
    const motion::ChainMotion found = motion::track_dominant(from->centres, to->chains.tracer(), kNever);
    EXPECT_EQ(motion::is_seen_through_smooth(found), diffuse < 0.2f) << diffuse;
    if (diffuse > 0.0f) continue;
    // In a mirror alone, what is reflected is the component Reflection.
    const motion::ChainMotion reflected = motion::track_components(from->centres, to->chains.tracer(), components_,
                                                                   1u << components_.find("Reflection"), kNever)
                                              .at(0);
    size_t same = 0, all = 0;
    for (size_t i = 0; i < found.film.size(); ++i) {
      if (reflected.tracking[i] != motion::Tracking::Tracked) continue;
      ++all;
      same += found.tracking[i] == motion::Tracking::Tracked && glm::length(found.film[i] - reflected.film[i]) < 2e-3f;
    }
    EXPECT_GT(all, 500u);
    EXPECT_GT(same, all * 95 / 100);
  }
}

// Regression: in animations, lines stood in mirrors that turn: the pixels beside the mirror's edge stood in it.
TEST_F(ComponentTracking, OfTheDominantEndsBesideTheEdgeOfItsMirror) {
  add_ball(mirror());
  const auto frame = seen();
  const std::vector<geometry::Hit>& hits = frame->centres.hits;
  std::optional<size_t> inside, beside;
  for (size_t i = 0; i < hits.size() && !(inside && beside); ++i) {
    if (!hits[i].valid()) continue;
    if (!inside) inside = i;
    if (hits[i].instance != hits[*inside].instance) beside = i;
  }
  ASSERT_TRUE(inside && beside);
  motion::ChainMotion chains;
  chains.film.assign(hits.size(), Vec2(-1.0f));
  chains.tracking.assign(hits.size(), motion::Tracking::Tracked);
  const auto arrives_in = [&](size_t pixel) {
    chains.film[*inside] = motion::centre_of(frame->centres.region, pixel);
    motion::ChainMotion left = chains;
    motion::lose_strayed_chains(frame->centres, frame->centres, &left);
    return left.tracking[*inside];
  };
  EXPECT_EQ(arrives_in(*inside), motion::Tracking::Tracked) << "the same pixel, at the edge or not";
  EXPECT_EQ(arrives_in(*beside), motion::Tracking::Occluded);
  ASSERT_EQ(hits[*beside - 1].instance, hits[*inside].instance);
  EXPECT_EQ(arrives_in(*beside - 1), motion::Tracking::Occluded) << "at the edge";
}

// A half-glossy wall in a mirror shows its diffuse light where it reflects nothing: the world is black.
TEST_F(ComponentTracking, OfTheDominantEndsOnAMixedSurfaceThatReflectsNothing) {
  add_ball(mirror());
  const auto seen_in_ball = [&](uint64_t walls) {
    for (const uint32_t wall : {0u, 1u, 2u}) scene_.scene.dress(wall, walls);
    scene_.scene.move(3, translation(Vec3(0.0f)));
    const auto from = seen();
    scene_.scene.move(3, translation(Vec3(0.02f, 0.03f, 0)));
    const auto to = seen();
    const motion::ChainMotion found = motion::track_dominant(from->centres, to->chains.tracer(), kNever);
    size_t count = 0;
    for (size_t i = 0; i < found.film.size(); ++i)
      count += from->centres.hits[i].instance == 3 && found.tracking[i] != motion::Tracking::NoPath;
    return count;
  };
  Surface mixed = glossy(0.0f);
  mixed.glossy = Rgb(0.7f);
  mixed.diffuse = Rgb(0.1f);
  const size_t of_grey = seen_in_ball(grey());
  EXPECT_GT(of_grey, 500u);
  EXPECT_EQ(seen_in_ball(scene_.material(mixed)), of_grey);
}

// An object comes into view in the mirror.
TEST_F(ComponentTracking, IsHiddenByAnObjectThatAppears) {
  add_ball(mirror());
  const auto from = seen();
  scene_.quad(Vec3(-1, -0.9f, 1.5f), Vec3(2, 0, 0), Vec3(0, 1, 0), grey());
  const auto to = seen();
  const motion::ChainMotion found = motion::track_components(from->centres, to->chains.tracer(), components_,
                                                             1u << components_.find("Reflection"), kNever)
                                        .at(0);
  EXPECT_GT(std::count(found.tracking.begin(), found.tracking.end(), motion::Tracking::Occluded), 20);
}

}  // namespace
}  // namespace gradus::test::component_tracking_test
