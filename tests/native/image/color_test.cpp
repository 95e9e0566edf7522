// F5: colour management with valid, invalid and missing configurations.
#include "image/color.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/types.h"

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
  color.to_scene_linear("sRGB", true, pixel, 1);
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
  std::vector<float> pixels(4 * 100000, 0.8f);
  color->to_scene_linear("halved", true, pixels.data(), pixels.size() / 4);
  EXPECT_NEAR(pixels.front(), 0.4f, 1e-6f);
  EXPECT_NEAR(pixels[pixels.size() - 2], 0.4f, 1e-6f);
  EXPECT_EQ(pixels.back(), 0.8f);
}

TEST_F(F5_ColorConfig, UnknownSpaceWarnsOnce) {
  const auto color = make("");
  EXPECT_EQ(color->transform("Odd", true), image::ColorTransform::Srgb);
  EXPECT_EQ(color->transform("Odd", false), image::ColorTransform::Data);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("Odd"), std::string::npos);
}

// Exponents, CDLs and tables are no curve and matrix. The values follow from their definitions.
TEST_F(F5_ColorConfig, ConvertsWhatIsNoCurveAndMatrix) {
  std::string table = "LUT_3D_SIZE 2\n";
  for (int i = 0; i < 8; i++) {  // red becomes the product of red and green at the corners of the cube
    table += (i == 3 || i == 7 ? "1 " : "0 ") + std::string(i & 2 ? "1 " : "0 ") + (i & 4 ? "1\n" : "0\n");
  }
  const std::string cube = fs::path(write(table)).filename().string();
  const auto color = make(write(config("scene_linear") +
                                "  - !<ColorSpace>\n    name: gamma\n    isdata: false\n    to_scene_reference: "
                                "!<ExponentTransform> {value: [2.2, 1.8, 2, 1]}\n"
                                "  - !<ColorSpace>\n    name: graded\n    isdata: false\n    to_scene_reference: "
                                "!<CDLTransform> {slope: [2, 1, 1], offset: [0.1, 0, 0], power: [2, 1, 1], sat: 1}\n"
                                "  - !<ColorSpace>\n    name: table\n    isdata: false\n    to_scene_reference: "
                                "!<FileTransform> {src: " +
                                cube + ", interpolation: linear}\n"));
  const auto convert = [&](const char* space) {
    Vec4 pixel(0.25f, 0.5f, 0.75f, 1.0f);
    EXPECT_EQ(color->transform(space, true), image::ColorTransform::Other) << space;
    color->to_scene_linear(space, true, &pixel.x, 1);
    return pixel;
  };
  EXPECT_NEAR(convert("gamma").x, std::pow(0.25f, 2.2f), 1e-4f);
  EXPECT_NEAR(convert("gamma").y, std::pow(0.5f, 1.8f), 1e-4f);
  EXPECT_NEAR(convert("graded").x, 0.36f, 1e-4f);
  EXPECT_NEAR(convert("graded").z, 0.75f, 1e-4f);
  EXPECT_NEAR(convert("table").x, 0.25f * 0.5f, 1e-4f);
  EXPECT_NEAR(convert("table").z, 0.75f, 1e-4f);
  EXPECT_TRUE(warnings_.empty()) << warnings_[0];
}

// Swaps red and blue, and squares green.
void swap_red_and_blue(float* rgba, size_t count) {
  for (; count > 0; count--, rgba += 4) {
    std::swap(rgba[0], rgba[2]);
    rgba[1] *= rgba[1];
  }
}

TEST_F(F5_ColorConfig, ASetConversionWins) {
  const auto color = make(write(config("scene_linear")));
  color->set_conversion("halved", swap_red_and_blue);
  EXPECT_EQ(color->transform("halved", true), image::ColorTransform::Other);
  float pixel[4] = {0.5f, 3.0f, 0.75f, 0.25f};
  color->to_scene_linear("halved", true, pixel, 1);
  EXPECT_EQ(pixel[0], 0.75f);
  EXPECT_EQ(pixel[1], 9.0f);
  EXPECT_EQ(pixel[2], 0.5f);
  EXPECT_EQ(pixel[3], 0.25f);
  EXPECT_THROW(color->set_conversion("", swap_red_and_blue), Error);
}

TEST_F(F5_ColorConfig, KnownConversionsAreRecognised) {
  const auto color = make("");
  color->set_conversion("same", [](float*, size_t) {});
  EXPECT_EQ(color->transform("same", true), image::ColorTransform::Data);
  color->set_conversion("curve", [](float* rgba, size_t count) {
    for (size_t i = 0; i < 4 * count; i++) rgba[i] = i % 4 < 3 ? image::srgb_to_linear(rgba[i]) : rgba[i];
  });
  EXPECT_EQ(color->transform("curve", true), image::ColorTransform::Srgb);
  EXPECT_EQ(color->fingerprint("curve", true), 0u);
}

TEST_F(F5_ColorConfig, TheFingerprintTellsConversionsApart) {
  const auto color = make("");
  color->set_conversion("space", swap_red_and_blue);
  const uint64_t first = color->fingerprint("space", true);
  color->set_conversion("space", [](float* rgba, size_t count) {
    swap_red_and_blue(rgba, count);
    for (size_t i = 0; i < 4 * count; i++) rgba[i] = std::min(rgba[i], 4.0f);  // differs in bright colours only
  });
  EXPECT_NE(color->fingerprint("space", true), first);
  EXPECT_NE(first, 0u);
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
  float pixel[4] = {1.0f, 0.0f, 0.0f, 1.0f};
  color->to_scene_linear("Linear ACEScg", false, pixel, 1);
  EXPECT_NEAR(pixel[0], 1.705f, 0.01f);
  EXPECT_NEAR(pixel[1], -0.130f, 0.01f);
}

}  // namespace
}  // namespace gradus::test::color_test
