// Correspondences at edges where pixels move in different ways.
#include "motion/parting_edges.h"

#include <gtest/gtest.h>

#include "support/path_scene.h"

namespace gradus::parting_edges_test {
namespace {

constexpr int kWidth = 24, kHeight = 9, kMoved = 4;

// A view whose pixels show the instance 1 in columns [first, last) and the instance 0 beside them.
motion::CentreView view(const integrator::IntegratorContext& context, int first, int last) {
  motion::CentreView view{context.snapshot.get(), context.camera, {0, 0, kWidth, kHeight}, {}, {}};
  view.hits.resize(size_t(kWidth) * kHeight);
  for (int i = 0; i < kWidth * kHeight; ++i)
    view.hits[size_t(i)].instance = i % kWidth >= first && i % kWidth < last ? 1 : 0;
  return view;
}

class PartingEdges : public ::testing::Test {
 protected:
  PartingEdges() { test::build(test::Scenario::DiffuseArea, &scene_); }

  // Returns where the pixels of the middle row go: those of columns [first, last) by kMoved pixels, the others stay.
  // `turns`: the pixels of the moving part appear and vanish at its outline, as those of a ball that rolls.
  std::vector<int32_t> kept(int first, int last, bool is_instance, bool turns = false) {
    const integrator::IntegratorContext context = scene_.context(test::test_settings(kWidth, kHeight));
    const auto shown = [&](int moved) {
      return is_instance ? view(context, first + moved, last + moved) : view(context, 0, 0);
    };
    const motion::CentreView from = shown(0), to = shown(kMoved);
    film::PixelCorrespondence found{std::vector<int32_t>(size_t(kWidth) * kHeight), {}};
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int x = i % kWidth;
      const bool moves = x >= first && x < last, is_hidden = !moves && x >= first + kMoved && x < last + kMoved,
                 leaves = moves && turns && x == last - 1;
      found.pixel[size_t(i)] = is_hidden || leaves ? film::kNoCorrespondence : moves ? i + kMoved + (turns ? 1 : 0) : i;
    }
    motion::leave_out_parting_edges(from, to, &found);
    const auto row = found.pixel.begin() + kHeight / 2 * kWidth;
    std::vector<int32_t> columns(row, row + kWidth);
    for (int32_t& column : columns) column = column < 0 ? -1 : column % kWidth;
    return columns;
  }

  test::PathScene scene_;
};

// The outline stays the outline, whether it is that of another instance or of what a mirror shows. The ground beside
// it, which holds light of both, does not go on to where the ground alone is seen, nor the other way round.
TEST_F(PartingEdges, OutlinesLeadToOutlines) {
  for (const bool is_instance : {true, false}) {
    const std::vector<int32_t> found = kept(6, 12, is_instance);
    // In a mirror nothing tells that the pixels beside the outline that appear and vanish show something else.
    const int first = is_instance ? 6 : 7, last = is_instance ? 12 : 11;
    for (int x = first; x < last; ++x) EXPECT_EQ(found[size_t(x)], x + kMoved) << x;
    EXPECT_EQ(found[5], -1) << "beside the outline, which moves away";
    EXPECT_EQ(found[16], -1) << "beside the outline, which has arrived";
    for (const int x : {0, 3, 18, 22}) EXPECT_EQ(found[size_t(x)], x);
  }
}

// The outline of a ball that rolls turns into its face, and holds light of the ground.
TEST_F(PartingEdges, OutlinesDoNotLeadIntoFaces) {
  const std::vector<int32_t> found = kept(6, 12, true, true);
  EXPECT_EQ(found[6], -1) << "comes from the outline";
  for (int x = 7; x < 10; ++x) EXPECT_EQ(found[size_t(x)], x + kMoved + 1) << x;
  EXPECT_EQ(found[10], -1) << "goes to the outline";
}

// Where all moves alike, edges are followed.
TEST_F(PartingEdges, EdgesThatMoveTogetherAreKept) {
  const std::vector<int32_t> found = kept(0, kWidth - kMoved, false);
  for (int x = 0; x < kWidth - kMoved; ++x) EXPECT_EQ(found[size_t(x)], x + kMoved) << x;
}

}  // namespace
}  // namespace gradus::parting_edges_test
