// Correspondences by component: specular chains lead to where the reflected or refracted object has moved.
#include <gtest/gtest.h>

#include "motion/component_tracking.h"
#include "render/component_replay.h"

namespace gradus::component_correspondence_test {
namespace {

// A row of six pixels, some of which have a chain.
class ComponentCorrespondence : public testing::Test {
 protected:
  ComponentCorrespondence() {
    motion_.film.assign(6, Vec2(0.0f));
    motion_.tracking.assign(6, motion::Tracking::NoPath);
  }
  void chain(int pixel, float x, motion::Tracking tracking = motion::Tracking::Tracked) {
    motion_.film[size_t(pixel)] = Vec2(x, 0.5f);
    motion_.tracking[size_t(pixel)] = tracking;
  }
  std::vector<int32_t> correspondence(const std::vector<int32_t>& surface) const {
    return motion::match_component({surface}, kRow, motion_).pixel;
  }

  const Region kRow{0, 0, 6, 1};
  motion::ChainMotion motion_;
  const std::vector<int32_t> static_{0, 1, 2, 3, 4, 5};
};

using Row = std::vector<int32_t>;

TEST_F(ComponentCorrespondence, FollowChainsWhereThereAreAnyAndSurfacesElsewhere) {
  chain(1, 2.4f);
  chain(2, 3.4f);
  EXPECT_EQ(correspondence(static_), (Row{0, 2, 3, -1, 4, 5}));  // pixel 3 belongs to the reflection now
}

// The object that the chain showed does not exist any more. The displacement of the surface is then the best choice,
// because it is that of the picture as a whole.
TEST_F(ComponentCorrespondence, FollowTheSurfaceWhereAChainWasLost) {
  chain(1, 1.5f, motion::Tracking::Occluded);
  EXPECT_EQ(correspondence(static_), static_);
}

TEST_F(ComponentCorrespondence, FollowTheSurfaceWhereThereIsNoChain) {
  EXPECT_FALSE(motion::is_seen_through_smooth(motion_));
  EXPECT_EQ(correspondence(static_), static_);
  chain(1, 4.5f, motion::Tracking::Gone);
  EXPECT_TRUE(motion::is_seen_through_smooth(motion_));
  EXPECT_EQ(correspondence(static_), static_);
}

TEST_F(ComponentCorrespondence, FollowTheSurfaceWhereAChainLeavesTheFilm) {
  chain(0, -0.5f);
  chain(5, 6.5f);
  EXPECT_EQ(correspondence(static_), static_);
}

TEST_F(ComponentCorrespondence, OfTwoChainsTheNearerToTheCentreHasThePixel) {
  chain(1, 3.9f);
  chain(2, 3.6f);
  chain(4, 3.1f);
  EXPECT_EQ(correspondence(static_), (Row{0, 1, 3, -1, 4, 5}));
}

// Regression: in animations, lines stood in mirrors that turn: pixels whose chain had no place followed the mirror.
TEST_F(ComponentCorrespondence, OfTheDominantNeverFollowsASurfaceThatShowsTrackedChains) {
  chain(1, 3.9f);
  chain(2, 3.6f);
  chain(4, 6.5f);
  chain(5, 1.0f, motion::Tracking::Gone);
  EXPECT_EQ(motion::match_dominant({static_}, kRow, motion_).pixel, (Row{0, -1, 3, -1, -1, 5}));
  chain(5, 1.0f, motion::Tracking::Occluded);
  EXPECT_EQ(motion::match_dominant({static_}, kRow, motion_).pixel, (Row{0, -1, 3, -1, -1, -1}));
}

TEST_F(ComponentCorrespondence, KeepTheEndsOfDisplacements) {
  chain(1, 2.375f);
  chain(4, 4.5f);
  const std::vector<Vec2> off =
      motion::match_component({static_, std::vector<Vec2>(6, Vec2(0.25f, 0.0f))}, kRow, motion_).off_centre;
  EXPECT_EQ(off[1], Vec2(-0.125f, 0.0f));
  EXPECT_EQ(off[4], Vec2(0.0f)) << "a static chain does not move at all";
  EXPECT_EQ(off[5], Vec2(0.25f, 0.0f)) << "the displacement of the surface";
}

TEST_F(ComponentCorrespondence, IgnoreAPositionThatIsNotFinite) {
  chain(1, NAN);
  EXPECT_EQ(correspondence(static_), static_);
}

TEST(ComponentReplays, AreMadeWhereDisplacementsDiffer) {
  film::ReplayMap replay_map;
  replay_map.correspondence.pixel = {0, 1, 2, film::kNoCorrespondence};
  replay_map.of_component = {{}, {Row{0, 3, film::kNoCorrespondence, 2}}};
  const render::ComponentReplays replays = render::replays_of_components(replay_map);
  ASSERT_EQ(replays.own.size(), 1u);
  EXPECT_EQ(replays.own[0].pixels, (std::vector<uint8_t>{0, 1, 0, 1}));
  EXPECT_EQ(replays.own[0].components, (std::vector<uint32_t>{0, 2, 0, 2}));
  EXPECT_EQ(replays.own[0].replay_map.correspondence, replay_map.of_component[1]);
  EXPECT_EQ(replays.shared, (std::vector<uint32_t>{lpe::kEveryComponent, ~2u, lpe::kEveryComponent, ~2u}));
  EXPECT_EQ(replays.pixels, 2u);
}

// Residual has the chains of what is seen through glass: its paths start with the same camera ray.
TEST(ComponentReplays, CombineComponentsWithTheSameDisplacements) {
  film::ReplayMap replay_map;
  replay_map.correspondence.pixel = {0, 1, 2, 3};
  replay_map.of_component = {{Row{1, 0, 2, 3}}, {}, {Row{1, 0, 3, 3}}, {Row{1, 1, 3, 3}}};
  film::ReplayMap limited = replay_map;
  render::limit_component_replays(&limited);
  EXPECT_EQ(limited.of_component, replay_map.of_component);
  const render::ComponentReplays replays = render::replays_of_components(replay_map);
  ASSERT_EQ(replays.own.size(), 2u);
  EXPECT_EQ(replays.own[0].components, (std::vector<uint32_t>{1u | 4u | 8u, 1u | 4u, 0, 0}));
  EXPECT_EQ(replays.own[1].components, (std::vector<uint32_t>{0, 0, 4u | 8u, 0}));
  EXPECT_EQ(replays.shared, (std::vector<uint32_t>{~13u, ~5u, ~12u, lpe::kEveryComponent}));
  EXPECT_EQ(replays.pixels, 3u);
}

TEST(ComponentReplays, AreAtMostOneForEachPixel) {
  film::ReplayMap replay_map;
  replay_map.correspondence.pixel = {0, 1, 2, 3};
  replay_map.of_component = {{Row{1, 0, 3, 3}}, {Row{2, 1, 2, 3}}, {Row{3, 1, 2, 3}}};
  film::ReplayMap limited = replay_map;
  render::limit_component_replays(&limited);
  EXPECT_EQ(limited.of_component,
            (std::vector<film::PixelCorrespondence>{replay_map.of_component[0], replay_map.of_component[1], {}}));
  EXPECT_LE(render::replays_of_components(limited).pixels, 4u);
}

// Regression: all components after one that exceeded the maximum were left out with it.
TEST(ComponentReplays, AComponentBeyondTheMaximumDoesNotExcludeOthers) {
  film::ReplayMap replay_map;
  replay_map.correspondence.pixel = {0, 1, 2, 3};
  replay_map.of_component = {{Row{1, 0, 3, 3}}, {Row{2, 3, 2, 2}}, {Row{0, 3, 2, 3}}};
  film::ReplayMap limited = replay_map;
  render::limit_component_replays(&limited);
  EXPECT_EQ(limited.of_component,
            (std::vector<film::PixelCorrespondence>{replay_map.of_component[0], {}, replay_map.of_component[2]}));
}

TEST(ComponentReplays, AreNoneWhereAllFollowTheSurface) {
  film::ReplayMap replay_map;
  replay_map.correspondence.pixel = {0, 1};
  EXPECT_TRUE(render::replays_of_components(replay_map).own.empty());
  EXPECT_TRUE(render::replays_of_components(replay_map).shared.empty());
}

}  // namespace
}  // namespace gradus::component_correspondence_test
