// L5: no compiler flag may assume finite numbers, reorder sums or depend on the building machine.
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace gradus::flags_test {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(L5_Flags, NumbersMayBeInfiniteAndSumsKeepTheirOrder) {
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
  FAIL() << "these tests were built with -ffast-math or -ffinite-math-only";
#endif
  const std::string commands = text_of(GRADUS_BINARY_DIR "/compile_commands.json");
  ASSERT_NE(commands.find("gradus_core.dir/"), std::string::npos);
  ASSERT_NE(commands.find("-Werror"), std::string::npos);
  for (const char* flag : {"-ffast-math", "-Ofast", "-ffinite-math", "-funsafe-math", "-fassociative-math",
                           "-freciprocal-math", "-fno-signed-zeros", "-march=native", "-mtune=native"}) {
    EXPECT_EQ(commands.find(flag), std::string::npos) << flag;
  }
}

}  // namespace
}  // namespace gradus::flags_test
