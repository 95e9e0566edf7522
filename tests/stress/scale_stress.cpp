// D5, D6: the same box in other units, and far from the origin.
#include <cmath>

#include "stress/stress.h"

namespace gradus::stress {
namespace {

Outcome boxed(const std::string& name, const Mat4& place, const Bounds& bounds = {}) {
  PathScene scene;
  scene.place = place;
  build_box(&scene);
  return render(name, &scene, bounds);
}

const Outcome& reference() {
  static const Outcome outcome = boxed("box", Mat4(1.0f));
  return outcome;
}

// Share of the blocks of 8×8 pixels that differ by more than 3 %.
double blocks_off(const std::vector<float>& rgba, const std::vector<float>& expected) {
  const GradusSettings settings = small_picture();
  const uint32_t columns = settings.width / 8, rows = settings.height / 8;
  std::vector<double> difference(columns * rows, 0.0), sum(difference);
  for (uint32_t i = 0; i < rgba.size(); ++i) {
    const uint32_t x = i / 4 % settings.width / 8, y = i / 4 / settings.width / 8;
    if (i % 4 == 3 || x >= columns || y >= rows) continue;
    difference[y * columns + x] += double(rgba[i]) - expected[i];
    sum[y * columns + x] += expected[i];
  }
  int off = 0;
  for (size_t i = 0; i < sum.size(); ++i) off += std::fabs(difference[i]) > 0.03 * sum[i] ? 1 : 0;
  return double(off) / double(sum.size());
}

// The random numbers are the same, so that only paths which rounding sends elsewhere differ.
void expect_like_reference(const Outcome& outcome, double largest) {
  EXPECT_NEAR(mean(outcome.noisy) / mean(reference().noisy), 1.0, 0.01);
  EXPECT_NEAR(mean(outcome.l2) / mean(reference().l2), 1.0, 0.01);
  EXPECT_LT(difference(outcome.l2, reference().l2), largest);
}

class D5_Scale : public ::testing::TestWithParam<int> {};

TEST_P(D5_Scale, TheBoxLooksTheSame) {
  const float scale = std::pow(10.0f, float(GetParam()));
  const Outcome outcome = boxed("box, scale 1e" + std::to_string(GetParam()), test::scaling(Vec3(scale)));
  expect_like_reference(outcome, 0.02);
  EXPECT_LE(blocks_off(outcome.noisy, reference().noisy), 0.01);
  EXPECT_LE(blocks_off(outcome.l2, reference().l2), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Decades, D5_Scale,
                         full_run() ? ::testing::ValuesIn(std::vector<int>{-4, -3, -2, -1, 1, 2, 3, 4})
                                    : ::testing::Values(-4, -2, 2, 4));

class D6_Distance : public ::testing::TestWithParam<float> {};

TEST_P(D6_Distance, TheBoxLooksTheSame) {
  const float far = GetParam();
  // Matrices come in float: at 1e5 the camera and the light stand on a grid of 8 mm, which moves edges and caustics.
  expect_like_reference(boxed("box at " + text_of(far) + " along all axes", test::translation(Vec3(far, -far, far))),
                        0.3);
}

INSTANTIATE_TEST_SUITE_P(Far, D6_Distance,
                         full_run() ? ::testing::ValuesIn(std::vector<float>{1e2f, 1e3f, 1e4f, 1e5f})
                                    : ::testing::Values(1e5f));

// Places are a metre apart there: half of the box is gone, and the camera may stand in a wall. It must only be finite.
TEST(D6_Distance, TenThousandKilometresAwayAllIsFinite) {
  boxed("box at 1e7", test::translation(Vec3(1e7f, 1e7f, -1e7f)));
}

// Vertices, not matrices, lie far away: on a grid of 8 mm at 1e5, a thousandth of this box.
TEST(D6_Distance, VerticesFarAway) {
  PathScene scene;
  const uint64_t white = scene.material(test::matte(Rgb(0.7f)));
  const Vec3 at(1e5f, -1e5f, 1e5f);
  scene.quad(at, Vec3(8, 0, 0), Vec3(0, 8, 0), white);
  scene.quad(at, Vec3(0, 8, 0), Vec3(0, 0, 8), white);
  scene.world(Rgb(1.0f));
  scene.camera(at + Vec3(20, 4, 20), at + Vec3(0, 4, 0), 0.6f);
  scene.camera_desc.clip_end = 100.0f;
  // It fills the picture but for its edges, where the constant world is seen.
  Bounds bounds;
  bounds.failed[kMissed] = 0.2;
  EXPECT_NEAR(mean(render("corner of vertices at 1e5", &scene, bounds).noisy), 0.85, 0.15);
}

}  // namespace
}  // namespace gradus::stress
