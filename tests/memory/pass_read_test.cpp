// Measures the memory that reading a pass takes in addition to its pixels.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "memory/allocations.h"
#include "output/pass_read.h"

namespace gradus::memory::pass_read_test {
namespace {

// Reading must take rows only. Before, Gradient X and Gradient Y were each cropped from three images of the whole
// frame, which took 1.2 GB at 8K.
TEST(PassRead, UsesRowsAndNoImages) {
  constexpr Region kRegion{0, 0, 1000, 400};
  const film::Film frame(1000, 400, kRegion, 3, 1, true);
  std::vector<float> pixels(size_t{3} * kRegion.area());
  for (const uint32_t pass : {GRADUS_PASS_GRADIENT_X, GRADUS_PASS_GRADIENT_Y, GRADUS_PASS_VARIANCE}) {
    tbb::task_arena(2).execute([&] {
      output::read_film_pass(frame, pass, kRegion, pixels.data());  // starts the threads
      forget_peak();
      const int64_t before = live_bytes();
      output::read_film_pass(frame, pass, kRegion, pixels.data());
      EXPECT_LT(peak_bytes() - before, int64_t(pixels.size() * sizeof(float)) / 8) << pass;
    });
  }
}

}  // namespace
}  // namespace gradus::memory::pass_read_test
