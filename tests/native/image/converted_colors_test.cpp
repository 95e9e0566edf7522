// Images in colour spaces that are neither data nor sRGB: alpha, values beyond 1, and scene files.
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/types.h"
#include "image/color.h"
#include "image/image.h"
#include "image/image_store.h"

namespace gradus::test::converted_colors_test {
namespace {

// A logarithmic curve, which maps black below 0, as those of cameras do.
float decode(float encoded) { return std::exp2(4.0f * encoded - 2.0f) - 0.3f; }

class ConvertedColors : public ::testing::Test {
 protected:
  ConvertedColors() {
    color.set_conversion("log", [](float* rgba, size_t count) {
      for (size_t i = 0; i < 4 * count; i++) rgba[i] = i % 4 < 3 ? decode(rgba[i]) : rgba[i] * 1.001f;
    });
  }
  static image::ImageSource source(const std::vector<float>& rgba, uint32_t alpha_mode) {
    image::ImageSource source;
    source.color_space = "log";
    source.alpha_mode = alpha_mode;
    source.is_float = true;
    source.tiles.resize(1);
    source.tiles[0].source = GRADUS_IMAGE_FLOAT;
    source.tiles[0].width = static_cast<uint32_t>(rgba.size() / 4);
    source.tiles[0].height = 1;
    source.tiles[0].data.resize(rgba.size() * sizeof(float));
    std::memcpy(source.tiles[0].data.data(), rgba.data(), source.tiles[0].data.size());
    return source;
  }
  Vec4 first_texel(const std::vector<float>& rgba, uint32_t alpha_mode) const {
    return image::load_image(source(rgba, alpha_mode), color)->tiles[0].texel(0, 0);
  }
  image::ColorManager color{"", nullptr};
};

TEST_F(ConvertedColors, StraightColoursAreMultipliedAfterwards) {
  const Vec4 texel = first_texel({0.5f, 0.75f, 1.0f, 0.25f}, GRADUS_ALPHA_ALWAYS_STRAIGHT);
  EXPECT_NEAR(texel.x, decode(0.5f) * 0.25f, 1e-6f);
  EXPECT_NEAR(texel.z, decode(1.0f) * 0.25f, 1e-6f);
  EXPECT_EQ(texel.w, 0.25f);
}

// Regression: colours that the file had multiplied by alpha were converted as they were.
TEST_F(ConvertedColors, AssociatedColoursAreConvertedWithoutAlpha) {
  const Vec4 texel = first_texel({0.125f, 0.1875f, 0.25f, 0.25f}, GRADUS_ALPHA_PREMULTIPLIED);
  EXPECT_NEAR(texel.x, decode(0.5f) * 0.25f, 1e-6f);
  EXPECT_NEAR(texel.z, decode(1.0f) * 0.25f, 1e-6f);
}

TEST_F(ConvertedColors, ChannelPackedColoursIgnoreAlpha) {
  for (const uint32_t mode : {GRADUS_ALPHA_CHANNEL_PACKED, GRADUS_ALPHA_NONE}) {
    EXPECT_NEAR(first_texel({0.5f, 0.75f, 1.0f, 0.25f}, mode).x, decode(0.5f), 1e-6f);
  }
}

// As in Cycles, whose conversion sees black where straight colours are invisible.
TEST_F(ConvertedColors, InvisibleColoursAreThoseOfBlack) {
  EXPECT_NEAR(first_texel({0.5f, 0.75f, 1.0f, 0.0f}, GRADUS_ALPHA_ALWAYS_STRAIGHT).x, decode(0.0f), 1e-6f);
  EXPECT_NEAR(first_texel({0.5f, 0.75f, 1.0f, 0.0f}, GRADUS_ALPHA_PREMULTIPLIED).x, decode(0.5f), 1e-6f);
}

TEST_F(ConvertedColors, FloatsBeyondOneAreConverted) {
  EXPECT_NEAR(first_texel({1.5f, -0.5f, 0.0f, 1.0f}, GRADUS_ALPHA_NONE).x, decode(1.5f), 1e-5f);
  EXPECT_NEAR(first_texel({1.5f, -0.5f, 0.0f, 1.0f}, GRADUS_ALPHA_NONE).y, decode(-0.5f), 1e-6f);
}

// A call of the host takes as long as a thousand pixels, and narrow images took one for each row.
TEST_F(ConvertedColors, RowsOfAnImageShareCalls) {
  constexpr uint32_t kWidth = 3, kHeight = 50000;
  size_t calls = 0;
  color.set_conversion("log", [&calls](float* rgba, size_t count) {
    ++calls;
    for (size_t i = 0; i < 4 * count; i++) rgba[i] = decode(rgba[i]);
  });
  std::vector<float> rgba(size_t{4} * kWidth * kHeight);
  for (size_t i = 0; i < rgba.size(); i++)
    rgba[i] = i % 4 == 3 ? 1.0f : static_cast<float>(i) / static_cast<float>(rgba.size());
  image::ImageSource tall = source(rgba, GRADUS_ALPHA_NONE);
  tall.tiles[0].width = kWidth;
  tall.tiles[0].height = kHeight;
  const auto loaded = image::load_image(tall, color);
  for (const uint32_t y : {0u, 21844u, 21845u, 43690u, kHeight - 1}) {
    const Vec4 texel = loaded->tiles[0].texel(2, y);
    EXPECT_NEAR(texel.y, decode(rgba[size_t{4} * (kWidth * y + 2) + 1]), 1e-5f) << y;
  }
  EXPECT_LE(calls, 4u);  // one of them finds out what the space is
}

TEST_F(ConvertedColors, AnotherConversionIsAnotherContent) {
  const image::ImageSource image = source({0.5f, 0.75f, 1.0f, 1.0f}, GRADUS_ALPHA_NONE);
  image::ColorManager other("", nullptr);
  other.set_conversion("log", [](float* rgba, size_t count) {
    for (size_t i = 0; i < 4 * count; i++) rgba[i] *= 0.5f;
  });
  EXPECT_NE(image::load_image(image, color)->content_hash, image::load_image(image, other)->content_hash);
}

// A scene file has no host that could convert its images.
TEST_F(ConvertedColors, SceneLinearSourcesNeedNoColorManager) {
  const image::ColorManager none("", nullptr);
  for (const uint32_t mode : {GRADUS_ALPHA_STRAIGHT, GRADUS_ALPHA_PREMULTIPLIED, GRADUS_ALPHA_CHANNEL_PACKED,
                              GRADUS_ALPHA_NONE, GRADUS_ALPHA_ALWAYS_STRAIGHT}) {
    const image::ImageSource original = source({0.5f, 0.75f, 1.5f, 0.25f, 0.5f, 0.25f, 0.125f, 0.0f}, mode);
    const auto expected = image::load_image(original, color);
    const auto loaded = image::load_image(image::scene_linear_source(original, color), none);
    ASSERT_TRUE(loaded->warnings.empty());
    EXPECT_EQ(loaded->ignores_alpha, expected->ignores_alpha);
    for (const uint32_t x : {0u, 1u}) {
      EXPECT_EQ(loaded->tiles[0].texel(x, 0), expected->tiles[0].texel(x, 0)) << mode;
    }
  }
}

TEST_F(ConvertedColors, SourcesThatNeedNoHostStayAsTheyAre) {
  image::ImageSource image = source({0.5f, 0.75f, 1.0f, 1.0f}, GRADUS_ALPHA_STRAIGHT);
  for (const char* space : {"", "sRGB"}) {
    image.color_space = space;
    const image::ImageSource same = image::scene_linear_source(image, color);
    EXPECT_EQ(same.color_space, space);
    EXPECT_EQ(same.tiles[0].data, image.tiles[0].data);
    EXPECT_EQ(same.alpha_mode, image.alpha_mode);
  }
}

}  // namespace
}  // namespace gradus::test::converted_colors_test
