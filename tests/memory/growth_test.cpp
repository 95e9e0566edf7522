// Tests that objects of the C API, renders and changes of a scene that are repeated many times leak no memory, files or
// threads.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "api/changing_scene.h"
#include "memory/allocations.h"
#include "memory/sequence.h"
#include "support/statistics.h"

namespace gradus::memory::growth_test {
namespace {

namespace fs = std::filesystem;

// Maximum number of threads that may start after the warm-up. Embree's task scheduler starts its workers, at most one
// per core, when it first has work for them.
int late_workers() { return int(std::thread::hardware_concurrency()); }

// Runs body(i) `count` times, after a tenth as many runs as a warm-up. Expects that the number of allocations and file
// descriptors does not grow, that the number of threads grows by no more than late_workers(), and that resident memory
// grows by at most 4 MB plus `pools` bytes, which allow for the memory pools of the allocators.
template <class Body>
void expect_no_growth(int count, uint64_t pools, const Body& body) {
  for (int i = 0; i < count / 10; ++i) body(i);
  const uint64_t resident = resident_bytes();
  const int files = descriptors(), workers = threads();
  const int64_t pieces = live();
  for (int i = 0; i < count; ++i) body(count / 10 + i);
  EXPECT_LE(live(), pieces);  // may fall, because Embree's threads free their start data when they first run
  EXPECT_EQ(descriptors(), files);
  EXPECT_LE(threads(), workers + late_workers());
  const uint64_t now = resident_bytes();
  EXPECT_LE(now, resident + (4u << 20) + pools);
  std::printf("  %d times: %+.2f MB\n", count, 1e-6 * (double(now) - double(resident)));
}

// Returns the bytes by which allocators' pools may grow in `count` runs. When several threads allocate at once, the
// pools grow rarely, by about 5 MB at a time, up to a limit (8 MB after 12,000 renders).
uint64_t pools_of(int count) { return std::min<uint64_t>(uint64_t(count) * 8192, 16u << 20); }

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

constexpr int kChanges = 15;  // number of frames after which the changes of the scene repeat

// Sets TMPDIR to a folder of the test's own, and expects that no temporary file is left there.
class J2_Growth : public test::WithScene<> {
 protected:
  void SetUp() override {
    const char* before = std::getenv("TMPDIR");
    before_ = before != nullptr ? before : "";
    folder_ = (fs::temp_directory_path() / "gradus-test-XXXXXX").string();
    if (mkdtemp(folder_.data()) == nullptr) throw std::runtime_error("cannot create a temporary folder");
    setenv("TMPDIR", folder_.c_str(), 1);
    WithScene<>::SetUp();
  }
  void TearDown() override {
    WithScene<>::TearDown();
    EXPECT_TRUE(fs::is_empty(folder_)) << "temporary files are left";
    fs::remove_all(folder_);
    if (before_.empty()) {
      unsetenv("TMPDIR");
    } else {
      setenv("TMPDIR", before_.c_str(), 1);
    }
  }

 private:
  std::string before_, folder_;
};

TEST_F(J2_Growth, FramesOfChangingTopology) {
  expect_no_growth(14 * kChanges, pools_of(200), [&](int i) { test::render_changing(scene, i % kChanges); });
}

TEST_F(J2_Growth, RepeatedExports) {
  expect_no_growth(50, pools_of(50), [&](int) {
    test::fill_scene(scene);
    EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
    test::render_changing(scene, 0);
  });
}

TEST_F(J2_Growth, CancelledFrames) {
  expect_no_growth(200, pools_of(200), [&](int i) {
    test::cancel_changing(scene, i % 20);
    test::set_changing(scene, 0);
  });
}

// Renders 20 animations of ten frames. On a busy machine resident memory grows by up to 0.35 MB each, though the number
// of allocations does not.
TEST_F(J2_Growth, Sequences) {
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    expect_no_growth(20, pools_of(500), [&](int) { test::animate_changing(device, scene, 10, -1, reconstruction); });
  }
}

TEST_F(J2_Growth, CancelledSequences) {
  expect_no_growth(200, pools_of(1000), [&](int i) {
    test::animate_changing(device, scene, 3, i % 6);
    test::set_changing(scene, 0);
  });
}

}  // namespace
}  // namespace gradus::memory::growth_test
