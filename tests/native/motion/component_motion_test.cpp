// Vectors of the passes, from the keys of one snapshot: previous − now, now − next.
#include "motion/component_motion.h"

#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "motion/motion_scene.h"

namespace gradus::test::component_motion_test {
namespace {

class ComponentMotionTest : public MotionTest {
 protected:
  static constexpr Region kRegion{0, 0, kSize, kSize};

  motion::ComponentMotion find(const integrator::IntegratorContext& context, const char* component) const {
    return motion::component_motion(*context.snapshot, context.settings, components_, 1u << components_.find(component),
                                    kRegion)
        .at(0);
  }
  // Sets the poses of instance 3 of the scene.
  void key(const Mat4& before, const Mat4& now, const Mat4& after) {
    const size_t count = scene_.scene.instance_count();
    scene_.scene.move(3, now);
    scene_.scene.matrices_before.assign(count, Mat4(1.0f));
    scene_.scene.matrices_after = scene_.scene.matrices_before;
    scene_.scene.matrices_before[3] = before;
    scene_.scene.matrices_after[3] = after;
  }

  // Motion from a frame to the frames before and after it, each found separately.
  struct Around {
    motion::ChainMotion before, after;
    bool tracks(size_t i) const {
      return before.tracking[i] == motion::Tracking::Tracked && after.tracking[i] == motion::Tracking::Tracked;
    }
    Vec4 vector(size_t i) const {
      const Vec2 centre(float(i % kSize) + 0.5f, float(i / kSize) + 0.5f);
      return Vec4(before.film[i] - centre, centre - after.film[i]);
    }
  };
  // go(false) moves the scene to the frame before, go(true) to the frame after.
  Around find_around(const MotionFrame* middle, const std::function<void(bool later)>& go) {
    const auto found_at = [&](bool later) {
      go(later);
      return motion(middle, frame("Reflection"));
    };
    return {found_at(false), found_at(true)};
  }
};

// Regression: callers that set all bits to request all components got 32, and wrote beyond the existing ones.
TEST_F(ComponentMotionTest, IsThatOfTheExistingComponents) {
  add_room();
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
  const MotionFrame* middle = frame("Diffuse");
  const auto all =
      motion::component_motion(*middle->context.snapshot, middle->context.settings, components_, ~uint32_t{0}, kRegion);
  EXPECT_EQ(all.size(), size_t(components_.count()));
}

// The keys of one snapshot give the same motion as three snapshots.
TEST_F(ComponentMotionTest, IsThatOfTheFramesAround) {
  add_ball(mirror());
  const Mat4 before = translation(Vec3(-0.05f, 0.01f, 0.02f)), now(1.0f),
             after = glm::rotate(translation(Vec3(0.03f, 0, 0)), 0.1f, Vec3(0, 1, 0));
  key(before, now, after);
  const MotionFrame* middle = frame("Reflection");
  const motion::ComponentMotion found = find(middle->context, "Reflection");
  const Around around = find_around(middle, [&](bool later) { scene_.scene.move(3, later ? after : before); });
  size_t tracked = 0;
  for (size_t i = 0; i < found.vectors.size(); ++i) {
    EXPECT_EQ(found.tracked[i] == 1.0f, around.tracks(i));
    if (!around.tracks(i)) {
      EXPECT_EQ(found.vectors[i], Vec4(0.0f));
      EXPECT_LT(found.tracked[i], 0.0f);
      continue;
    }
    ++tracked;
    EXPECT_LT(glm::length(found.vectors[i] - around.vector(i)), 5e-3f);
  }
  EXPECT_GT(tracked, 500u);
}

TEST_F(ComponentMotionTest, OfAMeshThatDeforms) {
  add_room();
  const Sheet now{48, 0.05f, 0.0f}, before{48, 0.05f, -0.1f}, after{48, 0.06f, 0.05f};
  const uint64_t material = mirror();
  set_sheet(&scene_, 900, now, &before, &after);
  scene_.scene.instance(900, Mat4(1.0f), GRADUS_VISIBLE_ALL, material);
  scene_.camera(Vec3(0.5f, 0.5f, 4), Vec3(0, 0, 0), 0.6f);
  const MotionFrame* middle = frame("Reflection");
  const motion::ComponentMotion found = find(middle->context, "Reflection");
  const Around around = find_around(middle, [&](bool later) { set_sheet(&scene_, 900, later ? after : before); });
  size_t tracked = 0, lost = 0;
  for (size_t i = 0; i < found.vectors.size(); ++i) {
    lost += around.tracks(i) && found.tracked[i] != 1.0f;
    if (found.tracked[i] != 1.0f || !around.tracks(i)) continue;
    ++tracked;
    EXPECT_LT(glm::length(found.vectors[i] - around.vector(i)), 0.02f);
  }
  EXPECT_GT(float(tracked), 0.75f * float(middle->chains.chains.size()));
  EXPECT_LT(float(lost), 0.01f * float(tracked));
}

// Directly visible surfaces have their surface motion, with the signs of Blender's Vector pass.
TEST_F(ComponentMotionTest, OfRoughSurfacesIsSurfaceMotion) {
  add_room();
  scene_.quad(Vec3(-1, -0.5f, 0), Vec3(2, 0, 0), Vec3(0, 1, 0), grey());
  scene_.camera(Vec3(0, 0, 4), Vec3(0, 0, 0), 4.0f / 4.0f);
  const float pixel = 4.0f / float(kSize);
  key(translation(Vec3(-2 * pixel, 0, 0)), Mat4(1.0f), translation(Vec3(0, 3 * pixel, 0)));
  const integrator::IntegratorContext context = scene_.context(test_settings(kSize, kSize));
  const motion::ComponentMotion found = find(context, "Diffuse");
  const size_t middle = size_t(kSize) * (kSize / 2) + kSize / 2, above = size_t(kSize) * (kSize - 4) + kSize / 2;
  EXPECT_LT(glm::length(found.vectors[middle] - Vec4(-2, 0, 0, -3)), 1e-3f);
  EXPECT_EQ(found.tracked[middle], 1.0f);
  EXPECT_EQ(found.vectors[above], Vec4(0.0f)) << "the wall does not move";
  EXPECT_EQ(found.tracked[above], 1.0f);
}

// Regression: an object that did not exist in the other frame counted as static, with a known motion.
TEST_F(ComponentMotionTest, OfAnObjectThatDidNotExistIsMarkedAsGone) {
  add_ball(grey());
  key(Mat4(NAN), Mat4(1.0f), Mat4(1.0f));
  const motion::ComponentMotion found = find(frame("Diffuse")->context, "Diffuse");
  const size_t middle = size_t(kSize) * kSize / 2 + kSize / 2;
  EXPECT_EQ(found.tracked[middle], float(motion::Tracking::Gone));
  EXPECT_EQ(found.vectors[middle], Vec4(0.0f));
  EXPECT_EQ(found.tracked[0], float(motion::Tracking::Tracked));
}

TEST_F(ComponentMotionTest, AcrossAShotChangeIsNone) {
  add_ball(grey());
  std::fill_n(scene_.camera_desc.matrix_next, 16, NAN);
  const MotionFrame* middle = frame("Diffuse");
  auto snapshot = std::make_shared<scene::Snapshot>(*middle->context.snapshot);
  EXPECT_TRUE(std::isfinite(snapshot->camera.matrix_next[0]));
  EXPECT_FALSE(snapshot->shot_change_before);
  EXPECT_TRUE(snapshot->shot_change_after);
  const motion::ComponentMotion found = find(middle->context, "Diffuse");
  for (size_t i = 0; i < found.tracked.size(); ++i) {
    if (found.tracked[i] == film::kNothingToTrack) continue;
    ASSERT_EQ(found.tracked[i], float(motion::Tracking::ShotChange)) << i;
  }
}

TEST_F(ComponentMotionTest, OnlyRequestedComponentsAreFound) {
  add_room();
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
  const integrator::IntegratorContext context = scene_.context(test_settings(kSize, kSize));
  EXPECT_TRUE(motion::component_motion(*context.snapshot, context.settings, components_, 0, kRegion).empty());
  const std::vector<motion::ComponentMotion> two =
      motion::component_motion(*context.snapshot, context.settings, components_, 0b110, kRegion);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].counts.pixels[1], 2u * kSize * kSize) << "nothing is reflected";
}

// The motion of a region is a crop of that of the film.
TEST_F(ComponentMotionTest, OfARegionIsThatOfTheWholeFilm) {
  add_ball(mirror());
  key(translation(Vec3(-0.02f, 0, 0)), Mat4(1.0f), translation(Vec3(0.02f, 0.01f, 0)));
  const integrator::IntegratorContext context = scene_.context(test_settings(kSize, kSize));
  const motion::ComponentMotion whole = find(context, "Reflection");
  const Region part{10, 12, 38, 36};
  const motion::ComponentMotion cut = motion::component_motion(*context.snapshot, context.settings, components_,
                                                               1u << components_.find("Reflection"), part)
                                          .at(0);
  for (int32_t y = part.y0; y < part.y1; ++y)
    for (int32_t x = part.x0; x < part.x1; ++x) {
      const size_t i = size_t((y - part.y0) * part.width() + x - part.x0), j = size_t(y * kSize + x);
      EXPECT_LT(glm::length(cut.vectors[i] - whole.vectors[j]), 5e-3f) << x << ' ' << y;
    }
}

// A ball moves in a corner: pixels that neither show it nor can be hidden by it are not searched.
TEST_F(ComponentMotionTest, StaticPixelsAreNotTraced) {
  add_room();
  scene_.ball(Vec3(-1.2f, 0, 0), 0.3f, mirror(), 32, true);
  scene_.ball(Vec3(1.2f, 0, 0), 0.5f, clear(), 32, true);
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 1.0f);
  key(translation(Vec3(-0.02f, 0, 0)), Mat4(1.0f), translation(Vec3(0.02f, 0.01f, 0)));
  const integrator::IntegratorContext context = scene_.context(test_settings(kSize, kSize));
  const motion::TrackingCounts seen_through = find(context, "Transmission").counts,
                               mirrored = find(context, "Reflection").counts;
  EXPECT_GT(seen_through.pixels[0], 100u);
  EXPECT_LT(float(seen_through.searched), 0.5f * float(seen_through.pixels[0]));
  EXPECT_GT(mirrored.searched, 20u);
}

TEST_F(ComponentMotionTest, CanBeCancelled) {
  add_room();
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
  const integrator::IntegratorContext context = scene_.context(test_settings(kSize, kSize));
  EXPECT_THROW(
      motion::component_motion(*context.snapshot, context.settings, components_, 2, kRegion, [] { return true; }),
      Error);
}

}  // namespace
}  // namespace gradus::test::component_motion_test
