// Refuses each allocation of a frame in turn, to test that every failure is reported and leaks nothing.
#include <thread>

#include "api/registry.h"
#include "memory/allocations.h"
#include "memory/sequence.h"
#include "support/statistics.h"

namespace gradus::memory::allocation_test {
namespace {

using test::error_text;

constexpr size_t kValues = 8 * 8 * 4;

// The result of a call whose k-th allocation was refused.
struct Attempt {
  bool hit = false;  // the call made at least k allocations
  GradusError code = GRADUS_OK;
  int64_t kept = 0;  // allocations that the call did not free
  std::string text;
};

// Makes a call while its k-th allocation is refused.
template <class Call>
Attempt attempt(uint64_t k, const Call& call) {
  Attempt result;
  const int64_t before = live();
  refuse(k);
  result.code = call();
  result.hit = was_refused();
  refuse(0);
  result.kept = live() - before;  // before the next line, which allocates a text
  result.text = error_text();
  return result;
}

// Makes a call while its k-th allocation is refused, and again if it keeps allocations: Embree's threads keep some when
// they first take part in a build, which on a busy machine is late. What a call leaks, it leaks every time.
template <class Call>
Attempt attempt_without_new_threads(uint64_t k, const Call& call) {
  Attempt result = attempt(k, call);
  for (unsigned late = 0; late < std::thread::hardware_concurrency() && result.kept > 0; ++late) {
    result = attempt(k, call);
  }
  return result;
}

class G5_Allocations : public ::testing::TestWithParam<uint32_t> {};

// Every refusal gives OUT_OF_MEMORY and no leak, and a render after all refusals has the bits of the first one.
TEST_P(G5_Allocations, EachMayBeRefused) {
  const GradusDevice device = test::make_device();
  std::vector<float> first(kValues), image(kValues);
  for (int warm_up = 0; warm_up < 3; ++warm_up) ASSERT_OK(render_once(device, GetParam(), &first));
  const uint64_t step = test::full_run() ? 1 : 7;
  int refusals = 0;
  for (uint64_t k = 1;; k += step, ++refusals) {
    const Attempt a = attempt_without_new_threads(k, [&] { return render_once(device, GetParam(), &image); });
    EXPECT_EQ(a.code, a.hit ? GRADUS_ERROR_OUT_OF_MEMORY : GRADUS_OK) << "allocation " << k << ": " << a.text;
    EXPECT_LE(a.kept, 0) << "allocation " << k;  // may fall: see expect_no_growth()
    if (!a.hit) break;
  }
  ASSERT_OK(render_once(device, GetParam(), &image));
  EXPECT_EQ(image, first);
  EXPECT_GT(refusals, test::full_run() ? 150 : 20);
  std::printf("  %d allocations refused\n", refusals);
  EXPECT_OK(gradus_device_release(device));
}

INSTANTIATE_TEST_SUITE_P(Integrators, G5_Allocations,
                         ::testing::Values(GRADUS_INTEGRATOR_AUTO, GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT));

// Creating a device without memory must report OUT_OF_MEMORY, and not that the processor lacks AVX2 or that another
// Embree is loaded, as it did before. Embree recovers from a few failed allocations, and leaks a few objects after
// others, so that leaks are not tested here.
TEST(G5_Device, WithoutMemoryReportsIt) {
  ASSERT_OK(gradus_device_release(test::make_device()));
  int refusals = 0, told = 0;
  for (uint64_t k = 1;; ++k, ++refusals) {
    const Attempt a = attempt(k, [] {
      GradusDeviceSettings settings = test::sized<GradusDeviceSettings>();
      settings.threads = 1;
      GradusDevice device = 0;
      const GradusError code = gradus_device_create(&settings, &device);
      return code == GRADUS_OK ? gradus_device_release(device) : code;
    });
    EXPECT_TRUE(a.code == GRADUS_OK || a.code == GRADUS_ERROR_OUT_OF_MEMORY) << "allocation " << k << ": " << a.text;
    if (!a.hit) break;
    told += a.code == GRADUS_OK ? 0 : 1;
  }
  EXPECT_GE(told, refusals - 4);
  EXPECT_GT(told, 20);
  ASSERT_OK(gradus_device_release(test::make_device()));
}

// A handle that cannot be added must leave its slot in the list of free slots. Before, each failure lost a slot,
// because the list had no room for it.
TEST(G5_Registry, ARefusedHandleLosesNoSlot) {
  for (uint64_t k = 1; k < 100; ++k) {
    api::Registry registry;
    const auto object = std::make_shared<int>(1);
    int added = 0;
    refuse(k);
    for (int i = 0; i < 20; ++i) {
      try {
        registry.add(api::HandleType::Film, object);
        ++added;
      } catch (const std::bad_alloc&) {
      }
    }
    const bool hit = was_refused();
    refuse(0);
    EXPECT_EQ(registry.size(), size_t(added)) << k;
    if (!hit) break;
  }
}

}  // namespace
}  // namespace gradus::memory::allocation_test
