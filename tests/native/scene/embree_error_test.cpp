// Embree builds on many threads and stores one error per thread: an error of a worker thread must reach the caller.
#include <atomic>
#include <thread>

#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "scene/device.h"
#include "scene/scene_fixture.h"

namespace gradus::embree_error_test {
namespace {

using namespace test;

struct Budget {
  std::atomic<int64_t> left;
  std::atomic<int> refused_elsewhere{0};
  std::thread::id caller = std::this_thread::get_id();
};

bool allow(void* data, ssize_t bytes, bool) {
  auto* budget = static_cast<Budget*>(data);
  if ((budget->left -= bytes) >= 0 || bytes <= 0) return true;
  budget->refused_elsewhere += std::this_thread::get_id() != budget->caller;
  return false;
}

// Commits with every limit on memory; returns the number of refusals on threads other than the caller's.
int commit_with_limits(TestScene* test, RTCDevice embree) {
  int elsewhere = 0;
  for (int64_t limit = 1 << 12; limit <= 1 << 23; limit += limit / 4) {
    Budget budget{limit};
    rtcSetDeviceMemoryMonitorFunction(embree, allow, &budget);
    try {
      test->commit();
      EXPECT_GE(budget.left, 0) << limit;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), GRADUS_ERROR_OUT_OF_MEMORY) << e.what();
    }
    rtcSetDeviceMemoryMonitorFunction(embree, nullptr, nullptr);
    elsewhere += budget.refused_elsewhere;
  }
  return elsewhere;
}

TEST(G5_Memory, AnErrorOfEmbreeOnAWorkerReachesTheCaller) {
  TestScene test;
  test.mesh(1, sphere(Vec3(0.0f), 1.0f, 200, 400));
  test.instance(1);
  int elsewhere = 0;  // the thread that allocates memory at the limit is random
  for (int round = 0; round < 50 && elsewhere == 0; ++round)
    elsewhere = commit_with_limits(&test, test_device()->embree().get());
  geometry::Hit hit;
  EXPECT_TRUE(test.commit()->intersect({Vec3(0, 0, 5), 0.0f, Vec3(0, 0, -1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
  if (elsewhere == 0) GTEST_SKIP() << "no worker took part";
}

}  // namespace
}  // namespace gradus::embree_error_test
