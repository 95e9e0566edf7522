// Objects of the C API that are created and released, and renders, leave no memory, files or threads behind.
#include "memory/growth.h"
#include "memory/sequence.h"
#include "support/statistics.h"

namespace gradus::memory {
namespace {

TEST(G10_Pairs, OfScenes) {
  const GradusDevice device = test::make_device();
  expect_no_growth(100000, 0, [device](int) {
    GradusScene scene = 0;
    ASSERT_OK(gradus_scene_create(device, &scene));
    ASSERT_OK(gradus_scene_release(scene));
  });
  EXPECT_OK(gradus_device_release(device));
}

TEST(G10_Pairs, OfDevices) {
  const int count = test::full_run() ? 1000 : 50;
  expect_no_growth(count, pools_of(count), [](int) { ASSERT_OK(gradus_device_release(test::make_device())); });
}

// Repeated renders, as for the frames of an animation, do not let the process grow.
TEST(J1_Growth, Renders) {
  const GradusDevice device = test::make_device();
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    std::vector<float> image(8 * 8 * 4);
    const int count = test::full_run() ? 2000 : 300;
    expect_no_growth(count, pools_of(count), [&](int) { ASSERT_OK(render_once(device, integrator, &image)); });
  }
  EXPECT_OK(gradus_device_release(device));
}

}  // namespace
}  // namespace gradus::memory
