// Optical flow: loading and refusing its library, by stand-ins; and the real library on known motion.
#include "motion/optical_flow.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/temporary_folder.h"

namespace gradus::optical_flow_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
const std::string kReal = GRADUS_BINARY_DIR "/native", kTests = GRADUS_BINARY_DIR "/tests/";

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A folder in which libgradus_flow.so is another file.
class StandIn {
 public:
  explicit StandIn(const std::string& file) {
    std::filesystem::create_symlink(file, std::filesystem::path(folder()) / "libgradus_flow.so");
  }
  std::string folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

std::string refusal(const std::string& folder) {
  std::string why_not;
  EXPECT_EQ(motion::find_flow_library(folder, &why_not), nullptr);
  return why_not;
}

std::shared_ptr<const motion::FlowLibrary> real() {
  std::string why_not;
  auto library = motion::find_flow_library(kReal, &why_not);
  if (!library) throw std::runtime_error(why_not);
  return library;
}

// Returns waves of many directions and lengths, so that there is texture everywhere. Shifted by `shift`.
motion::GreyImage waves(int width, int height, const Vec2& shift) {
  motion::GreyImage image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = float(x) - shift.x, v = float(y) - shift.y;
      const float sum = std::sin(0.31f * u + 0.05f * v) + std::sin(0.27f * v - 0.11f * u + 1.0f) +
                        std::sin(0.13f * u + 0.19f * v + 2.0f);
      image.levels.push_back(128.0f + 40.0f * sum);
    }
  }
  return image;
}

float largest_error(const std::vector<Vec2>& flow, int width, int height, int border, const Vec2& truth) {
  float largest = 0.0f;
  for (int y = border; y < height - border; ++y) {
    for (int x = border; x < width - border; ++x)
      largest = std::max(largest, glm::length(flow[size_t(y * width + x)] - truth));
  }
  return largest;
}

TEST(OpticalFlow, ShiftsAreFoundToATenthOfAPixel) {
  const auto library = real();
  for (const Vec2 shift : {Vec2(0.0f), Vec2(0.3f, -0.2f), Vec2(-1.6f, 2.2f), Vec2(5.25f, 3.5f)}) {
    const auto flow = motion::optical_flow(*library, waves(160, 120, Vec2(0.0f)), waves(160, 120, shift));
    EXPECT_LT(largest_error(flow, 160, 120, 16, shift), 0.1f) << shift.x << " " << shift.y;
  }
}

TEST(OpticalFlow, OddAndTinySizesAreFiniteAndBounded) {
  const auto library = real();
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1), std::pair(7, 5), std::pair(33, 17), std::pair(500, 3)}) {
    const auto flow =
        motion::optical_flow(*library, waves(width, height, Vec2(0.0f)), waves(width, height, Vec2(3.0f, -2.0f)));
    ASSERT_EQ(flow.size(), size_t(width * height));
    for (const Vec2& v : flow)
      ASSERT_TRUE(std::abs(v.x) <= float(width) && std::abs(v.y) <= float(height)) << width << " " << height;
  }
  EXPECT_TRUE(motion::optical_flow(*library, {}, {}).empty());
}

TEST(OpticalFlow, ConstantAndInvalidLevelsGiveFiniteVectors) {
  const auto library = real();
  const motion::GreyImage flat{48, 40, std::vector<float>(48 * 40, 77.0f)};
  for (const Vec2& v : motion::optical_flow(*library, flat, flat)) ASSERT_EQ(v, Vec2(0.0f));
  motion::GreyImage broken = waves(48, 40, Vec2(0.0f));
  broken.levels[5] = kNaN, broken.levels[700] = kInfinity, broken.levels[900] = -1e30f, broken.levels[1200] = 1e30f;
  for (const Vec2& v : motion::optical_flow(*library, broken, flat))
    ASSERT_TRUE(std::abs(v.x) <= 48.0f && std::abs(v.y) <= 40.0f);
}

// The result of DIS depends on the number of stripes, which is its number of threads by default.
TEST(OpticalFlow, ManyThreadsAtOnceFindTheSame) {
  const auto library = real();
  const motion::GreyImage from = waves(200, 150, Vec2(0.0f)), to = waves(200, 150, Vec2(2.5f, 1.0f));
  const auto alone = motion::optical_flow(*library, from, to);
  std::vector<std::vector<Vec2>> found(4);
  std::vector<std::thread> threads;
  for (auto& flow : found) threads.emplace_back([&] { flow = motion::optical_flow(*library, from, to); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& flow : found) EXPECT_EQ(flow, alone);
}

TEST(FlowLibrary, NamesTheVersionOfOpenCv) { EXPECT_TRUE(has(real()->version(), ".")); }

TEST(FlowLibrary, IsFoundBesideTheLibraryThatLoadsIt) {
  EXPECT_EQ(motion::flow_library_folder(), std::filesystem::canonical(kTests.substr(0, kTests.size() - 1)).string());
}

TEST(FlowLibrary, IsRefusedWithAReason) {
  EXPECT_TRUE(has(refusal("/no/such/folder"), "/no/such/folder/libgradus_flow.so: there is no such file"));
  EXPECT_TRUE(has(refusal(StandIn(GRADUS_SOURCE_DIR "/README.md").folder()), "libgradus_flow.so: "));
  EXPECT_TRUE(has(refusal(StandIn(kTests + "libfake_oidn.so").folder()), "it has no gradus_flow_interface"));
  EXPECT_TRUE(has(refusal(StandIn(kTests + "libfake_flow_incomplete.so").folder()), "it has no gradus_flow_version"));
  EXPECT_TRUE(has(refusal(StandIn(kTests + "libfake_flow_old.so").folder()), "it has interface 0 in place of 1"));
}

TEST(FlowLibrary, AMissingOneIsReportedOnceAndByName) {
  Warnings warnings;
  std::string text;
  EXPECT_NE(motion::flow_library_or_warning(kReal, &warnings), nullptr);
  EXPECT_FALSE(warnings.take(&text));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(motion::flow_library_or_warning("/no/such/folder", &warnings), nullptr);
  ASSERT_TRUE(warnings.take(&text));
  EXPECT_EQ(text,
            "no motion of shadows and of reflections on rough surfaces (/no/such/folder/libgradus_flow.so: there is no "
            "such file)");
  EXPECT_FALSE(warnings.take(&text));
}

class FakeFlow : public ::testing::Test {
 protected:
  void TearDown() override { unsetenv("FAKE_FLOW"); }
  static std::vector<Vec2> flow(const char* behaviour) {
    setenv("FAKE_FLOW", behaviour, 1);
    const StandIn place(kTests + "libfake_flow.so");
    std::string why_not;
    const auto library = motion::find_flow_library(place.folder(), &why_not);
    if (!library) throw std::runtime_error(why_not);
    return motion::optical_flow(*library, waves(8, 6, Vec2(0.0f)), waves(8, 6, Vec2(0.0f)));
  }
};

TEST_F(FakeFlow, ItsErrorsAreReported) {
  try {
    flow("fails");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "optical flow: the fake fails");
  }
}

TEST_F(FakeFlow, VectorsAreNoLongerThanTheImage) {
  for (const Vec2& v : flow("nan")) EXPECT_EQ(v, Vec2(0.0f));
  for (const Vec2& v : flow("far")) EXPECT_EQ(v, Vec2(8.0f, 6.0f));
}

}  // namespace
}  // namespace gradus::optical_flow_test
