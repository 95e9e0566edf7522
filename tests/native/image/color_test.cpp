// F5: colour management with valid, invalid and missing configurations.
#include "image/color.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"

namespace gradus::test::color_test {
namespace {

namespace fs = std::filesystem;

class F5_ColorConfig : public ::testing::Test {
 protected:
  std::unique_ptr<image::ColorManager> make(const std::string& path) {
    return std::make_unique<image::ColorManager>(path, [this](const std::string& text) { warnings_.push_back(text); });
  }
  // Writes a configuration to a temporary file and returns its path.
  std::string write(const std::string& text) {
    const fs::path path =
        fs::path(::testing::TempDir()) / ("gradus_color_" + std::to_string(fs::hash_value(text)) + ".ocio");
    std::ofstream(path) << text;
    return path.string();
  }
  static std::string config(const std::string& role) {
    return "ocio_profile_version: 2\nstrictparsing: true\nroles:\n  " + role +
           ": lin\n  default: lin\ndisplays:\n  sRGB:\n    - !<View> {name: Raw, colorspace: raw}\nactive_displays: "
           "[]\nactive_views: []\n"
           "colorspaces:\n  - !<ColorSpace>\n    name: lin\n    isdata: false\n  - !<ColorSpace>\n    name: raw\n    "
           "isdata: true\n"
           "  - !<ColorSpace>\n    name: halved\n    isdata: false\n    to_scene_reference: !<MatrixTransform> "
           "{matrix: [0.5, 0, 0, 0, 0, "
           "0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}\n";
  }
  std::vector<std::string> warnings_;
};

void expect_builtin(const image::ColorManager& color) {
  EXPECT_EQ(color.transform("sRGB", true), image::ColorTransform::Srgb);
  EXPECT_EQ(color.transform("Linear", false), image::ColorTransform::Data);
  EXPECT_EQ(color.transform("Linear Rec.709", false), image::ColorTransform::Data);
  EXPECT_EQ(color.transform("Non-Color", true), image::ColorTransform::Data);
  EXPECT_EQ(color.transform("", true), image::ColorTransform::Data);
  float pixel[4] = {0.5f, 0.0f, 1.0f, 0.25f};
  color.to_scene_linear("sRGB", true, pixel, 1, 4);
  EXPECT_NEAR(pixel[0], 0.21404114f, 1e-6f);
  EXPECT_EQ(pixel[1], 0.0f);
  EXPECT_NEAR(pixel[2], 1.0f, 1e-6f);
  EXPECT_EQ(pixel[3], 0.25f);
}

TEST_F(F5_ColorConfig, TheDefaultIsBuiltIn) {
  const auto color = make("");
  expect_builtin(*color);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(F5_ColorConfig, MissingWarnsOnceWithThePath) {
  const auto color = make("/nowhere/config.ocio");
  expect_builtin(*color);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("/nowhere/config.ocio"), std::string::npos);
}

TEST_F(F5_ColorConfig, UnreadableFallsBack) {
  for (const std::string& path : {write("this is: [no configuration"), write("")}) {
    warnings_.clear();
    const auto color = make(path);
    expect_builtin(*color);
    EXPECT_EQ(warnings_.size(), 1u) << path;
  }
}

// Regression: OpenColorIO read a folder as an empty file and leaked memory.
TEST_F(F5_ColorConfig, FolderFallsBackAndIsCalledOne) {
  const auto color = make(fs::temp_directory_path().string());
  expect_builtin(*color);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("it is a folder"), std::string::npos) << warnings_[0];
}

TEST_F(F5_ColorConfig, WithoutSceneLinearRoleFallsBack) {
  const auto color = make(write(config("data")));
  expect_builtin(*color);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("scene-linear"), std::string::npos);
}

TEST_F(F5_ColorConfig, ConvertsBySpacesOfTheConfiguration) {
  const auto color = make(write(config("scene_linear")));
  EXPECT_TRUE(warnings_.empty()) << warnings_[0];
  EXPECT_EQ(color->transform("lin", false), image::ColorTransform::Data);
  EXPECT_EQ(color->transform("raw", true), image::ColorTransform::Data);
  EXPECT_EQ(color->transform("halved", true), image::ColorTransform::Other);
  std::vector<float> pixels(3 * 100000, 0.8f);
  color->to_scene_linear("halved", true, pixels.data(), pixels.size() / 3, 3);
  EXPECT_NEAR(pixels.front(), 0.4f, 1e-6f);
  EXPECT_NEAR(pixels.back(), 0.4f, 1e-6f);
}

TEST_F(F5_ColorConfig, UnknownSpaceWarnsOnce) {
  const auto color = make("");
  EXPECT_EQ(color->transform("Odd", true), image::ColorTransform::Srgb);
  EXPECT_EQ(color->transform("Odd", false), image::ColorTransform::Data);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("Odd"), std::string::npos);
}

TEST_F(F5_ColorConfig, OverrideWins) {
  const auto color = make("");
  const float curve[3] = {0.0f, 0.25f, 1.0f};
  GradusColorSpace space{sizeof(GradusColorSpace), 3, "sRGB", curve, {0, 1, 0, 1, 0, 0, 0, 0, 2}};
  color->set_override(space);
  EXPECT_EQ(color->transform("sRGB", true), image::ColorTransform::Other);
  float pixel[3] = {0.5f, 1.0f, 0.75f};
  color->to_scene_linear("sRGB", true, pixel, 1, 3);
  EXPECT_NEAR(pixel[0], 1.0f, 1e-6f);
  EXPECT_NEAR(pixel[1], 0.25f, 1e-6f);
  EXPECT_NEAR(pixel[2], 1.25f, 1e-6f);
  space.matrix[4] = NAN;
  EXPECT_THROW(color->set_override(space), Error);
}

// Float images exceed the range of the curve's samples, and contain NaN.
TEST_F(F5_ColorConfig, BeyondItsSamplesACurveContinuesWithItsLastSlope) {
  const auto color = make("");
  const float curve[3] = {0.0f, 0.25f, 1.0f};
  color->set_override({sizeof(GradusColorSpace), 3, "sRGB", curve, {1, 0, 0, 0, 1, 0, 0, 0, 1}});
  float pixel[6] = {2.0f, -1.0f, 0.5f, NAN, NAN, NAN};
  color->to_scene_linear("sRGB", false, pixel, 2, 3);
  EXPECT_NEAR(pixel[0], 2.5f, 1e-6f);
  EXPECT_NEAR(pixel[1], -0.5f, 1e-6f);
  EXPECT_TRUE(std::isnan(pixel[3]));
}

// Blender's own configuration, if it is installed.
TEST_F(F5_ColorConfig, BlendersConfiguration) {
  const std::string path = "/usr/share/blender/datafiles/colormanagement/config.ocio";
  if (!fs::exists(path)) {
    GTEST_SKIP() << "no Blender installed";
  }
  const auto color = make(path);
  EXPECT_TRUE(warnings_.empty());
  expect_builtin(*color);
  EXPECT_EQ(color->transform("Filmic sRGB", true), image::ColorTransform::Other);
  // ACEScg has another red primary: pure ACEScg red lies outside of Rec. 709.
  float pixel[3] = {1.0f, 0.0f, 0.0f};
  color->to_scene_linear("Linear ACEScg", false, pixel, 1, 3);
  EXPECT_NEAR(pixel[0], 1.705f, 0.01f);
  EXPECT_NEAR(pixel[1], -0.130f, 0.01f);
}

}  // namespace
}  // namespace gradus::test::color_test
