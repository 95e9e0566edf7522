// The search over the film: how it ends, and what it costs.
#include "motion/film_search.h"

#include "motion/chain_view.h"
#include "motion/motion_scene.h"

namespace gradus::test::film_search_test {
namespace {

class FilmSearchTest : public MotionTest {
 protected:
  // Searches from a pixel to the new position of the object that it shows; the mirror is static.
  motion::SearchEnd search_from(const MotionFrame& from, const MotionFrame& to, int32_t x, int32_t y,
                                motion::SearchCounts* counts) {
    const motion::SpecularChain* chain = from.chains.at(x, y);
    EXPECT_NE(chain, nullptr);
    const motion::ChainTracer before = from.chains.tracer(), after = to.chains.tracer();
    motion::Target target;
    EXPECT_TRUE(motion::true_target(before, after, *chain, &target));
    const motion::Target own{chain->shown, false};
    const motion::FilmSearch::Problem problem{before, after, chain->signature, own, target, Vec2(0.0f)};
    motion::FilmPlace place,
        start{Vec2(float(x) + 0.5f, float(y) + 0.5f), *chain, motion::chain_jacobian(from.chains, own, x, y)};
    return motion::FilmSearch(problem, counts).leap(start, start.film, &place);
  }
};

// A wall that slides sideways takes its image out of the mirror: the search notices that at once, not by small steps up
// to the edge of the mirror.
TEST_F(FilmSearchTest, EndsWhereTheImageLeavesItsMirror) {
  scene_.quad(Vec3(-1, -1, 2), Vec3(2, 0, 0), Vec3(0, 0, -4), mirror());
  scene_.quad(Vec3(-4, -1, -2), Vec3(8, 0, 0), Vec3(0, 3, 0), grey());
  scene_.camera(Vec3(0, 1.0f, 4), Vec3(0, -0.5f, 0), 1.0f);
  const MotionFrame* a = frame("Reflection");
  scene_.scene.move(1, translation(Vec3(0.3f, 0, 0)));
  const MotionFrame* b = frame("Reflection");
  constexpr int32_t kRow = 20;
  int32_t last = kSize - 1;
  while (last > 0 && a->chains.at(last, kRow) == nullptr) --last;
  ASSERT_GT(last, kSize / 2);
  motion::SearchCounts inside, leaving;
  EXPECT_EQ(search_from(*a, *b, kSize / 2, kRow, &inside), motion::SearchEnd::Found);
  EXPECT_EQ(search_from(*a, *b, last - 1, kRow, &leaving), motion::SearchEnd::Ended);
  EXPECT_LT(leaving.traced, 20u);
}

}  // namespace
}  // namespace gradus::test::film_search_test
