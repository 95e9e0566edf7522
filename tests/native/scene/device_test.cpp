#include "scene/device.h"

#include <atomic>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "base/fpu.h"

namespace gradus::device_test {
namespace {

TEST(Device, TasksFlushDenormalsAndTheCallerKeepsItsState) {
  GradusDeviceSettings settings{};
  settings.struct_size = sizeof(settings);
  settings.threads = 2;
  scene::Device device(settings);
  ASSERT_FALSE(FlushDenormals::active());
  std::atomic<int> without{0};
  device.arena().execute([&] {
    tbb::parallel_for(0, 1000, [&](int) {
      if (!FlushDenormals::active()) ++without;
    });
  });
  EXPECT_EQ(without, 0);
  EXPECT_FALSE(FlushDenormals::active());
}

TEST(Warnings, AreIssuedOnceAndInOrder) {
  Warnings warnings;
  warnings.add("a");
  warnings.add("b");
  warnings.add("a");
  std::string text;
  EXPECT_TRUE(warnings.take(&text));
  EXPECT_EQ(text, "a");
  EXPECT_TRUE(warnings.take(&text));
  EXPECT_EQ(text, "b");
  EXPECT_FALSE(warnings.take(&text));
}

}  // namespace
}  // namespace gradus::device_test
