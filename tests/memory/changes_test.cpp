// Tests for leaks in 200 frames with changing meshes and instances, 50 repeated exports and 200 cancelled renders, both
// for single frames and for animations.
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "api/changing_scene.h"
#include "memory/growth.h"

namespace gradus::memory {
namespace {

namespace fs = std::filesystem;

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

TEST_F(J2_Growth, FramesOfOtherTopology) {
  expect_no_growth(14 * kChanges, pools_of(200), [&](int i) { test::render_changing(scene, i % kChanges); });
}

TEST_F(J2_Growth, ExportsAnew) {
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

// Renders 20 animations of ten frames.
TEST_F(J2_Growth, Sequences) {
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    expect_no_growth(20, pools_of(200), [&](int) { test::animate_changing(device, scene, 10, -1, reconstruction); });
  }
}

TEST_F(J2_Growth, CancelledSequences) {
  expect_no_growth(200, pools_of(1000), [&](int i) {
    test::animate_changing(device, scene, 3, i % 6);
    test::set_changing(scene, 0);
  });
}

}  // namespace
}  // namespace gradus::memory
