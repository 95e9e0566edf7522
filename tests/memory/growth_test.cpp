// G10, and J1 for the library: what is created and released leaves nothing behind.
#include <algorithm>
#include <thread>

#include "memory/allocations.h"
#include "memory/sequence.h"
#include "support/statistics.h"

namespace gradus::memory {
namespace {

// The scheduler beneath Embree starts its workers, at most one per core, when there first is work for one to take: it may be after the
// warm-up.
int late_workers() { return int(std::thread::hardware_concurrency()); }

// Runs `body` `count` times after a tenth of it as a warm-up. Nothing is kept; descriptors stay, and threads but for late workers. RSS may
// grow by 4 MB, and by the pools of the allocators.
template <class Body>
void expect_no_growth(int count, uint64_t pools, const Body& body) {
  for (int i = 0; i < count / 10; ++i) body();
  const uint64_t resident = resident_bytes();
  const int files = descriptors(), workers = threads();
  const int64_t pieces = live();
  for (int i = 0; i < count; ++i) body();
  EXPECT_LE(live(), pieces);  // Embree's threads give back what started them when they come to run
  EXPECT_EQ(descriptors(), files);
  EXPECT_LE(threads(), workers + late_workers());
  const uint64_t now = resident_bytes();
  EXPECT_LE(now, resident + (4u << 20) + pools);
  std::printf("  %d times: %+.2f MB\n", count, 1e-6 * (double(now) - double(resident)));
}

// Where threads meet in them, the pools grow in steps of some 5 MB, seldom, and end (12,000 renders: 8 MB).
uint64_t pools_of(int count) { return std::min<uint64_t>(uint64_t(count) * 8192, 16u << 20); }

TEST(G10_Pairs, OfScenes) {
  const GradusDevice device = test::make_device();
  expect_no_growth(100000, 0, [device] {
    GradusScene scene = 0;
    ASSERT_OK(gradus_scene_create(device, &scene));
    ASSERT_OK(gradus_scene_release(scene));
  });
  EXPECT_OK(gradus_device_release(device));
}

TEST(G10_Pairs, OfDevices) {
  const int count = test::full_run() ? 1000 : 50;
  expect_no_growth(count, pools_of(count), [] { ASSERT_OK(gradus_device_release(test::make_device())); });
}

// Frames of an animation, for the library.
TEST(J1_Growth, Renders) {
  const GradusDevice device = test::make_device();
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    std::vector<float> image(8 * 8 * 4);
    const int count = test::full_run() ? 2000 : 300;
    expect_no_growth(count, pools_of(count), [&] { ASSERT_OK(render_once(device, integrator, &image)); });
  }
  EXPECT_OK(gradus_device_release(device));
}

}  // namespace
}  // namespace gradus::memory
