// G5: each allocation of a frame is refused once.
#include "memory/allocations.h"
#include "memory/sequence.h"
#include "support/statistics.h"

namespace gradus::memory {
namespace {

using test::error_text;

constexpr size_t kValues = 8 * 8 * 4;

class G5_Allocations : public ::testing::TestWithParam<uint32_t> {};

// One OUT_OF_MEMORY, nothing is kept, and the next render has the bits of the first.
TEST_P(G5_Allocations, EachMayBeRefused) {
  const GradusDevice device = test::make_device();
  std::vector<float> first(kValues), image(kValues);
  for (int warm_up = 0; warm_up < 3; ++warm_up) ASSERT_OK(render_once(device, GetParam(), &first));
  refuse(0);
  ASSERT_OK(render_once(device, GetParam(), &first));
  const uint64_t all = refuse(0);
  const uint64_t step = test::full_run() ? 1 : 7;
  int refusals = 0;
  for (uint64_t k = 1; k <= all; k += step) {
    const int64_t before = live();
    refuse(k);
    const GradusError code = render_once(device, GetParam(), &image);
    const bool hit = was_refused();
    refuse(0);
    const int64_t kept = live() - before;  // now: messages of failures are pieces, too
    const std::string text = error_text();
    if (hit) {
      ++refusals;
      // A few allocations can be done without: a copy of a text, say.
      EXPECT_TRUE(code == GRADUS_ERROR_OUT_OF_MEMORY || code == GRADUS_OK) << "allocation " << k << ": " << code << ' ' << text;
    } else {
      EXPECT_EQ(code, GRADUS_OK) << text;
    }
    EXPECT_EQ(kept, 0) << "allocation " << k;
  }
  ASSERT_OK(render_once(device, GetParam(), &image));
  EXPECT_EQ(image, first);
  EXPECT_GT(refusals, test::full_run() ? 150 : 20);
  std::printf("  %d of %llu allocations refused\n", refusals, static_cast<unsigned long long>(all));
  EXPECT_OK(gradus_device_release(device));
}

INSTANTIATE_TEST_SUITE_P(Integrators, G5_Allocations, ::testing::Values(GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT));

}  // namespace
}  // namespace gradus::memory
