// J2: frames of changing meshes and instances, and cancelled renders, release everything. LeakSanitizer (make
// test-full) looks for leaks; tests/memory counts allocations, files and threads.
#include "api/changing_scene.h"

namespace gradus::test::changes_test {
namespace {

class J2_Changes : public WithScene<> {};

TEST_F(J2_Changes, FramesAreReleased) {
  for (int32_t frame = 0; frame < 15; ++frame) render_changing(scene, frame);
}

TEST_F(J2_Changes, CancelledFramesAreReleased) {
  for (int32_t frame = 0; frame < 20; ++frame) cancel_changing(scene, frame);
}

TEST_F(J2_Changes, SequencesAreReleasedAfterACancelInAnyFrame) {
  constexpr int32_t kLast = 5;
  animate_changing(device, scene, kLast);
  for (int number = 0; number < 2 * kLast; ++number) animate_changing(device, scene, kLast, number);
}

}  // namespace
}  // namespace gradus::test::changes_test
