// Every test begins with an empty error slot. The slot of a thread keeps its first error until that is read, so a test
// would find the error of an earlier one.
#include <gtest/gtest.h>

#include "gradus/gradus.h"

namespace gradus::test {
namespace {

class EmptyErrorSlot : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo&) override { gradus_error(nullptr); }
};

const bool kAdded = [] {
  testing::UnitTest::GetInstance()->listeners().Append(new EmptyErrorSlot);  // the list owns it
  return true;
}();

}  // namespace
}  // namespace gradus::test
