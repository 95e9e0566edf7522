// The host's denoiser: loading and refusing it, by stand-ins for the library; and the real library if there is one.
#include <dlfcn.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"
#include "output/denoise.h"

namespace gradus::denoise_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
const std::string kFolder = GRADUS_BINARY_DIR "/tests/", kFake = kFolder + "libfake_oidn.so";
const auto never = [] { return false; };

class FakeOidn : public ::testing::Test {
 protected:
  void TearDown() override {
    unsetenv("FAKE_OIDN");
    EXPECT_EQ(value("live"), 0) << "devices and filters that were not released";
  }
  static void behave(const char* how) { setenv("FAKE_OIDN", how, 1); }
  static int value(const char* name) {
    void* const library = dlopen(kFake.c_str(), RTLD_LAZY | RTLD_LOCAL);
    const auto ask = reinterpret_cast<int (*)(const char*)>(dlsym(library, "fake_oidn_value"));
    const int result = ask(name);
    dlclose(library);
    return result;
  }
  static std::shared_ptr<const output::OidnLibrary> fake() {
    std::string why_not;
    auto library = output::find_oidn({kFake, "libno_such_oidn.so"}, &why_not);
    EXPECT_TRUE(library) << why_not;
    return library;
  }
  static std::string refusal(const output::OidnPlaces& places) {
    std::string why_not;
    EXPECT_EQ(output::find_oidn(places, &why_not), nullptr);
    return why_not;
  }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(FakeOidn, IsFoundByItsFileAndByItsFolder) {
  for (const std::string& path : {kFake, kFolder}) {
    std::string why_not;
    const auto library = output::find_oidn({path, "libfake_oidn.so"}, &why_not);
    ASSERT_TRUE(library) << why_not;
    EXPECT_EQ(library->version, "2.7.5");
  }
}

TEST_F(FakeOidn, IsFoundIfTheProcessHasLoadedIt) {
  const output::OidnPlaces nowhere{"", "libfake_oidn_mapped.so"},
      elsewhere{"/no/such/folder/lib.so", "libfake_oidn_mapped.so"};
  EXPECT_TRUE(has(refusal(nowhere), "libfake_oidn_mapped.so"));
  EXPECT_TRUE(has(refusal(elsewhere), "/no/such/folder/lib.so"));
  ASSERT_TRUE(dlopen((kFolder + "libfake_oidn_mapped.so").c_str(), RTLD_LAZY | RTLD_LOCAL));
  std::string why_not;
  EXPECT_TRUE(output::find_oidn(nowhere, &why_not)) << why_not;
  EXPECT_TRUE(output::find_oidn(elsewhere, &why_not)) << why_not;
}

TEST_F(FakeOidn, IsRefusedWithAReason) {
  EXPECT_TRUE(
      has(refusal({kFolder + "libfake_oidn_incomplete.so", "libno_such_oidn.so"}), "it has no oidnSetFilterInt"));
  EXPECT_TRUE(has(refusal({GRADUS_SOURCE_DIR "/README.md", "libno_such_oidn.so"}), "README.md: "));
  EXPECT_TRUE(has(refusal({kFolder, "libno_such_oidn.so"}), "libno_such_oidn.so: "));
  behave("old");
  EXPECT_TRUE(has(refusal({kFake, "libno_such_oidn.so"}), "it has version 1.7.5 in place of 2"));
  behave("no_device");
  EXPECT_TRUE(has(refusal({kFake, "libno_such_oidn.so"}), "it cannot create a device: the fake makes no device"));
}

// Regression: the message named the path twice, and did not say what should be there.
TEST_F(FakeOidn, AnEmptyPathIsNamedOnce) {
  for (const std::string& path :
       {std::string("/no/such/lib.so"), kFolder, std::string(GRADUS_SOURCE_DIR "/README.md")}) {
    const std::string text = refusal({path, "libno_such_oidn.so"});
    const size_t first = text.find(path);
    ASSERT_NE(first, std::string::npos) << text;
    EXPECT_EQ(text.find(path, first + 1), std::string::npos) << text;
    if (path.back() == 'd') continue;  // a file that is no library
    EXPECT_TRUE(has(text, "it should be libno_such_oidn.so or the folder that holds it")) << text;
  }
}

// 2 x 2 pixels.
const std::vector<float> kColor = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
const std::vector<float> kAlbedo(12, 0.5f), kNormal(12, 0.25f);

output::NoisyPicture picture(const std::vector<float>& color, size_t stride = 3) {
  output::NoisyPicture result;
  result.width = result.height = 2;
  result.color = color.data();
  result.stride = stride;
  return result;
}
std::vector<float> plus(float offset) {
  std::vector<float> result = kColor;
  for (float& v : result) v += offset;
  return result;
}

TEST_F(FakeOidn, ThePictureAlonePassesTheNetworkOnce) {
  const int before = value("runs");
  EXPECT_EQ(output::denoise(*fake(), picture(kColor), 3, never), plus(1.0f));
  EXPECT_EQ(value("runs"), before + 1);
  EXPECT_EQ(value("hdr"), 1);
  EXPECT_EQ(value("numThreads"), 3);
  EXPECT_EQ(value("setAffinity"), 0);
  EXPECT_EQ(value("quality"), output::kOidnQualityHigh);
}

TEST_F(FakeOidn, TheFourthChannelIsSkipped) {
  std::vector<float> rgba;
  for (size_t i = 0; i < 4; ++i) rgba.insert(rgba.end(), {kColor[3 * i], kColor[3 * i + 1], kColor[3 * i + 2], kNaN});
  EXPECT_EQ(output::denoise(*fake(), picture(rgba, 4), 1, never), plus(1.0f));
}

TEST_F(FakeOidn, GuidesAreUsedUnchanged) {
  const int before = value("runs");
  output::NoisyPicture p = picture(kColor);
  p.albedo = kAlbedo.data();
  p.normal = kNormal.data();
  EXPECT_EQ(output::denoise(*fake(), p, 1, never), plus(1 + 0.5f + 2.5f));
  EXPECT_EQ(value("cleanAux"), 1);
  EXPECT_EQ(value("runs"), before + 1);
}

TEST_F(FakeOidn, AlbedoAloneGuidesUnchangedAndNormalsAloneDoNot) {
  output::NoisyPicture p = picture(kColor);
  p.albedo = kAlbedo.data();
  EXPECT_EQ(output::denoise(*fake(), p, 1, never), plus(1.5f));
  p = picture(kColor);
  p.normal = kNormal.data();
  EXPECT_EQ(output::denoise(*fake(), p, 1, never), plus(1.0f));
}

TEST_F(FakeOidn, ValuesThatAreNotFiniteCountAsZero) {
  std::vector<float> color = kColor, albedo = kAlbedo, normal = kNormal;
  color[0] = kNaN, color[5] = kInfinity, color[11] = -kInfinity, albedo[1] = kNaN, normal[2] = kInfinity;
  output::NoisyPicture p = picture(color);
  p.albedo = albedo.data();
  p.normal = normal.data();
  std::vector<float> expected = plus(4.0f);
  expected[0] = expected[5] = expected[11] = 4.0f, expected[1] -= 0.5f, expected[2] -= 2.5f;
  EXPECT_EQ(output::denoise(*fake(), p, 1, never), expected);
}

TEST_F(FakeOidn, HugeValuesStayFinite) {
  const std::vector<float> color(12, std::numeric_limits<float>::max());
  for (const float v : output::denoise(*fake(), picture(color), 1, never)) EXPECT_LE(v, 2e30f);
}

TEST_F(FakeOidn, ResultsThatAreNotFiniteAreReplacedByThePicture) {
  behave("nan");
  const std::vector<float> result = output::denoise(*fake(), picture(kColor), 1, never);
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(result[i], kColor[i] + float(i % 2 == 0));
}

TEST_F(FakeOidn, ErrorsCarryItsMessage) {
  const auto failure = [](const char* how) {
    const auto library = fake();
    behave(how);
    std::string text;
    try {
      output::denoise(*library, picture(kColor), 1, never);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), GRADUS_ERROR_UNKNOWN);
      text = e.what();
    }
    unsetenv("FAKE_OIDN");
    return text;
  };
  EXPECT_EQ(failure("no_device"), "Open Image Denoise: the fake makes no device");
  EXPECT_EQ(failure("no_filter"), "Open Image Denoise: the fake makes no filter");
  EXPECT_EQ(failure("refuses"), "Open Image Denoise: the fake refuses its parameters");
  EXPECT_EQ(failure("fails"), "Open Image Denoise: the fake has no memory");
}

TEST_F(FakeOidn, StopsWhenCancelled) {
  output::NoisyPicture p = picture(kColor);
  p.albedo = kAlbedo.data();
  p.normal = kNormal.data();
  for (const int requested : {0, 1, 5, 12}) {  // in every phase
    int count = 0;
    try {
      output::denoise(*fake(), p, 1, [&] { return ++count > requested; });
      ADD_FAILURE() << requested;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), GRADUS_ERROR_CANCELLED) << requested;
    }
    EXPECT_LE(count, requested + 2) << "went on";
  }
}

double rms_error(const std::vector<float>& image, const std::vector<float>& truth) {
  double sum = 0.0;
  for (size_t i = 0; i < truth.size(); ++i) sum += std::pow(double(image[i]) - truth[i], 2);
  return std::sqrt(sum / double(truth.size()));
}

// Denoises two noisy walls with and without guides, and a picture of values that are not finite or too large. Returns
// an error message or "".
std::string check_real_library(const std::string& path) {
  std::string why_not;
  const auto library = output::find_oidn({path}, &why_not);
  if (!library || !has(library->version, "2.")) return why_not + ", or another version";
  output::NoisyPicture p;
  p.width = 67, p.height = 41;
  std::vector<float> truth, noisy, albedo, normal;
  std::mt19937 generator(1);
  std::exponential_distribution<float> noise(1.0f);
  for (int i = 0; i < p.width * p.height * 3; ++i) {
    const float value = i / 3 % p.width < 30 ? 0.2f : 0.8f;
    truth.push_back(value), noisy.push_back(value * noise(generator)), albedo.push_back(value);
    normal.push_back(i % 3 == 2 ? 1.0f : 0.0f);
  }
  p.color = noisy.data();
  const double before = rms_error(noisy, truth), plain = rms_error(output::denoise(*library, p, 2, never), truth);
  p.albedo = albedo.data();
  p.normal = normal.data();
  const double guided = rms_error(output::denoise(*library, p, 2, never), truth);
  if (plain > 0.3 * before || guided > 0.3 * before || guided > plain) return "too much noise is left";
  std::fill(noisy.begin(), noisy.end(), std::numeric_limits<float>::max());
  noisy[0] = kNaN;
  for (const float v : output::denoise(*library, p, 2, never)) {
    if (!std::isfinite(v)) return "not finite";
  }
  return "";
}

// Runs in a process of its own; in this one, the real library would stay loaded for tests of the stand-ins.
TEST(HostDenoiserDeathTest, RemovesNoise) {
  const std::string path = GRADUS_SOURCE_DIR "/.venv/bpy45/lib/python3.11/site-packages/bpy/lib";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "there is no " << path;
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto check = [&] {
    const std::string failure = check_real_library(path);
    std::cerr << failure << std::endl;
    _exit(failure.empty() ? 0 : 1);
  };
  EXPECT_EXIT(check(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace gradus::denoise_test
