// Images at lower resolutions.
#include <cmath>

#include <gtest/gtest.h>

#include "image/image_test_support.h"

namespace gradus::test::coarser_tile_test {
namespace {

using Pixel = std::array<uint8_t, 4>;

// An image of bytes whose pixels are a function of column and row.
template <class Pixels>
StoredImage bytes(uint32_t width, uint32_t height, const std::string& space, Pixels&& pixel,
                  uint32_t alpha_mode = GRADUS_ALPHA_STRAIGHT) {
  image::ImageSource source;
  source.color_space = space;
  source.alpha_mode = alpha_mode;
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_BYTE;
  source.tiles[0].width = width;
  source.tiles[0].height = height;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const Pixel p = pixel(x, y);
      source.tiles[0].data.insert(source.tiles[0].data.end(), p.begin(), p.end());
    }
  }
  return with_coarser(store_source(source));
}

Vec4 averaged(const StoredImage& image, const Vec2& uv, float extent,
              image::Interpolation interpolation = image::Interpolation::Linear, bool unassociate = false) {
  return image.store.lookup(image.index, uv, interpolation, image::Extension::Repeat, unassociate, extent);
}

Pixel grey(uint8_t v) { return {v, v, v, 255}; }

// Odd and even columns have different values.
Pixel stripe(uint32_t x, uint32_t) { return grey(x % 2 ? 255 : 0); }

TEST(CoarserTile, KeepsAConstantColour) {
  const Pixel color = {200, 100, 3, 255};
  for (const char* space : {"sRGB", "Non-Color"}) {
    const StoredImage image = bytes(256, 256, space, [&](uint32_t, uint32_t) { return color; });
    EXPECT_NEAR(glm::distance(averaged(image, Vec2(0.3f), 1.0f), averaged(image, Vec2(0.3f), 0.0f)), 0.0f, 1e-4f);
  }
}

// Returns the mean of many look-ups at full resolution.
Vec4 mean_in_full(const StoredImage& image, bool unassociate = false) {
  Vec4 sum(0.0f);
  constexpr int kSide = 400;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      sum += averaged(image, (Vec2(x, y) + 0.5f) / float(kSide), 0.0f, image::Interpolation::Linear, unassociate);
  return sum / float(kSide * kSide);
}

// Regression: encoded values were decoded before they were interpolated, so that stripes had 0.5 where look-ups find
// 0.31 in the mean.
TEST(CoarserTile, IsTheMeanOfAllLookUps) {
  for (const char* space : {"sRGB", "Non-Color"}) {
    const StoredImage image = bytes(256, 256, space, stripe);
    EXPECT_NEAR(averaged(image, Vec2(0.3f), 0.1f).x, mean_in_full(image).x, 0.002f) << space;
  }
}

// Regression: colours that are multiplied by alpha were too dark, because the mean was multiplied after encoding.
TEST(CoarserTile, IsTheMeanOfColoursTimesAlpha) {
  const auto leaf = [](uint32_t x, uint32_t y) { return Pixel{200, 120, 40, uint8_t((x / 2 + y / 2) % 2 ? 255 : 0)}; };
  for (const char* space : {"sRGB", "Non-Color"}) {
    const StoredImage image = bytes(256, 256, space, leaf);
    const Vec4 expected = mean_in_full(image), found = averaged(image, Vec2(0.3f), 0.1f);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(found[c], expected[c], 0.004f) << space << c;
  }
}

TEST(CoarserTile, TexelsAreNotLongerThanTheExtent) {
  const StoredImage image = bytes(256, 256, "Non-Color", stripe);
  EXPECT_EQ(averaged(image, Vec2(127.5f / 256.0f), 3.9f / 256.0f), Vec4(1.0f));
  EXPECT_NEAR(averaged(image, Vec2(127.5f / 256.0f), 4.0f / 256.0f).x, 0.5f, 0.003f);
  // A stripe of 16 columns is seen at an extent of 4 to 15 texels, and lost at one of 16.
  const StoredImage wide =
      bytes(1024, 1024, "Non-Color", [](uint32_t x, uint32_t) { return grey(x % 16 < 8 ? 0 : 255); });
  EXPECT_NEAR(averaged(wide, Vec2(12.0f / 1024.0f), 15.9f / 1024.0f).x, 1.0f, 1e-6f);
  EXPECT_NEAR(averaged(wide, Vec2(12.0f / 1024.0f), 16.0f / 1024.0f).x, 0.5f, 0.003f);
}

// Pixel art shows its texels.
TEST(CoarserTile, ClosestIsNotAveraged) {
  const StoredImage image = bytes(256, 256, "Non-Color", stripe);
  EXPECT_EQ(averaged(image, Vec2(0.501f), 1.0f, image::Interpolation::Closest).x, 0.0f);
}

// The colour under transparent texels does not show: a red leaf on transparent green stays red.
TEST(CoarserTile, TransparentTexelsCountByAlpha) {
  const auto leaf = [](uint32_t x, uint32_t) { return x % 2 ? Pixel{255, 0, 0, 255} : Pixel{0, 255, 0, 0}; };
  for (const char* space : {"sRGB", "Non-Color"}) {
    const Vec4 color = averaged(bytes(256, 256, space, leaf), Vec2(0.3f), 1.0f, image::Interpolation::Linear, true);
    EXPECT_NEAR(color.x, 1.0f, 0.02f) << space;  // 8 bits of red times alpha
    EXPECT_NEAR(color.y, 0.0f, 0.01f) << space;
    EXPECT_NEAR(color.w, 0.5f, 0.003f) << space;
  }
  const StoredImage packed = bytes(256, 256, "Non-Color", leaf, GRADUS_ALPHA_CHANNEL_PACKED);
  EXPECT_NEAR(averaged(packed, Vec2(0.3f), 1.0f).y, 0.5f, 0.003f);
}

// Sizes that are no multiple of four keep the mean, and positions within a texel.
TEST(CoarserTile, OfAnySize) {
  const StoredImage ramp = bytes(251, 131, "Non-Color", [](uint32_t x, uint32_t y) {
    return Pixel{static_cast<uint8_t>(x), static_cast<uint8_t>(y), 0, 255};
  });
  for (const float at : {0.2f, 0.5f, 0.83f}) {
    const Vec4 fine = averaged(ramp, Vec2(at), 0.0f), coarse = averaged(ramp, Vec2(at), 0.04f);
    EXPECT_NEAR(coarse.x * 255.0f, fine.x * 255.0f, 1.0f);
    EXPECT_NEAR(coarse.y * 255.0f, fine.y * 255.0f, 1.0f);
  }
}

TEST(CoarserTile, TakesAFifteenthOfTheMemoryOrTwo) {
  const StoredImage data = bytes(1024, 1024, "Non-Color", stripe), image = bytes(1024, 1024, "sRGB", stripe);
  EXPECT_LT(data.store.memory_bytes(), size_t{1024} * 1024 * 4 * 16 / 15);
  EXPECT_TRUE(image.store.can_be_coarser(image.index));
  EXPECT_LT(image.store.memory_bytes(), size_t{1024} * 1024 * 4 * 17 / 15);
  EXPECT_FALSE(bytes(63, 1024, "sRGB", stripe).store.can_be_coarser(0));
}

}  // namespace
}  // namespace gradus::test::coarser_tile_test
