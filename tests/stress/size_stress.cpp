// D5, D6 and E8: the same box in other units, far from the origin, and in pictures of extreme sizes.
#include <cmath>

#include "stress/stress.h"

namespace gradus::stress::size_stress {
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

// Returns the share of blocks of 8×8 pixels that differ by more than 3 %.
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

// The random numbers are the same, so that only paths that rounding changes differ.
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
  // Matrices are floats: at 1e5, the camera and the light lie on a grid of 8 mm, which moves edges and caustics.
  expect_like_reference(boxed("box at " + text_of(far) + " along all axes", test::translation(Vec3(far, -far, far))),
                        0.3);
}

INSTANTIATE_TEST_SUITE_P(Far, D6_Distance,
                         full_run() ? ::testing::ValuesIn(std::vector<float>{1e2f, 1e3f, 1e4f, 1e5f})
                                    : ::testing::Values(1e5f));

// Positions are a metre apart there: half of the box is lost, and the camera may be inside of a wall. The picture must
// only be finite.
TEST(D6_Distance, TenThousandKilometresAwayIsFinite) {
  boxed("box at 1e7", test::translation(Vec3(1e7f, 1e7f, -1e7f)));
}

// Vertices instead of matrices lie far away: on a grid of 8 mm at 1e5, a thousandth of this box.
TEST(D6_Distance, VerticesFarAway) {
  PathScene scene;
  const uint64_t white = scene.material(test::matte(Rgb(0.7f)));
  const Vec3 at(1e5f, -1e5f, 1e5f);
  scene.quad(at, Vec3(8, 0, 0), Vec3(0, 8, 0), white);
  scene.quad(at, Vec3(0, 8, 0), Vec3(0, 0, 8), white);
  scene.world(Rgb(1.0f));
  scene.camera(at + Vec3(20, 4, 20), at + Vec3(0, 4, 0), 0.6f);
  scene.camera_desc.clip_end = 100.0f;
  // The box fills the picture up to its edges, where the constant world is visible.
  Bounds bounds;
  bounds.failed[kMissed] = 0.2;
  EXPECT_NEAR(mean(render("corner of vertices at 1e5", &scene, bounds).noisy), 0.85, 0.15);
}

// A picture of one pixel, or of an extreme aspect ratio.
struct Size {
  uint32_t width, height, samples;
};
void PrintTo(const Size& size, std::ostream* out) { *out << size.width << " x " << size.height; }

class Sizes : public ::testing::TestWithParam<Size> {};

TEST_P(Sizes, AreRendered) {
  const auto [width, height, samples] = GetParam();
  PathScene scene;
  build_box(&scene);
  if (height > width) scene.camera(Vec3(0, 0, 3.2f), Vec3(0.0f), 0.9f * float(width) / float(height));
  GradusSettings settings = small_picture();
  settings.width = width;
  settings.height = height;
  settings.samples = samples;
  // With one sample, the variance is unknown. Neighbouring pixels are half a box apart in small pictures: most of their
  // shifts may fail, at several light samples each.
  Bounds bounds = samples > 1 ? Bounds() : Bounds().without_double();
  if (width * height < 1000) bounds.failed = {1.0, 1.0, 1.0, 0.2, 0.2, 0.3, 0.5};
  const Outcome outcome = render(std::to_string(width) + " x " + std::to_string(height), &scene, bounds, settings);
  EXPECT_EQ(outcome.l2.size(), size_t(width) * height * 4);
  EXPECT_NEAR(mean(outcome.l2), mean(outcome.noisy), 1e-4 * mean(outcome.noisy));
}

INSTANTIATE_TEST_SUITE_P(Odd, Sizes,
                         ::testing::Values(Size{1, 1, 64}, Size{2, 1, 16}, Size{1, 7, 16}, Size{7, 1, 16},
                                           Size{17, 33, 4}, Size{16384, 16, 1}, Size{1, 4096, 1}, Size{16, 16384, 1}));

}  // namespace
}  // namespace gradus::stress::size_stress
