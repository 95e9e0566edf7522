// E8 for the library: pictures of one pixel, and as long as they get.
#include <cmath>

#include "stress/stress.h"

namespace gradus::stress {
namespace {

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
  // With one sample no variance is known. Neighbouring pixels are half a box apart in small pictures: most of their
  // shifts may fail, at several lights each.
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
}  // namespace gradus::stress
