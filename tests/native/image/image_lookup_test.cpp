// Look-ups: extension, interpolation, alpha, colour, tiles.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/error.h"
#include "image/image_test_support.h"

namespace gradus::test::image_lookup_test {
namespace {

// Two texels: black on the left, white on the right.
StoredImage black_and_white() {
  image::ImageSource source;
  source.color_space = "Non-Color";
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_BYTE;
  source.tiles[0].width = 2;
  source.tiles[0].height = 1;
  source.tiles[0].data = {0, 0, 0, 255, 255, 255, 255, 255};
  return store_source(source);
}

image::ImageSource rgba_source(const std::vector<uint8_t>& pixel, uint32_t alpha_mode, const std::string& space) {
  image::ImageSource source;
  source.color_space = space;
  source.alpha_mode = alpha_mode;
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_BYTE;
  source.tiles[0].width = source.tiles[0].height = 1;
  source.tiles[0].data = pixel;
  return source;
}

TEST(ImageLookup, ExtensionOfClosest) {
  const StoredImage image = black_and_white();
  const auto at = [&](float u, image::Extension e) { return image.at(u, 0.5f, image::Interpolation::Closest, e).x; };
  EXPECT_EQ(at(0.25f, image::Extension::Repeat), 0.0f);
  EXPECT_EQ(at(0.75f, image::Extension::Repeat), 1.0f);
  EXPECT_EQ(at(1.25f, image::Extension::Repeat), 0.0f);
  EXPECT_EQ(at(-0.25f, image::Extension::Repeat), 1.0f);
  EXPECT_EQ(at(1.25f, image::Extension::Extend), 1.0f);
  EXPECT_EQ(at(-3.0f, image::Extension::Extend), 0.0f);
  EXPECT_EQ(at(1.25f, image::Extension::Mirror), 1.0f);
  EXPECT_EQ(at(1.75f, image::Extension::Mirror), 0.0f);
  EXPECT_EQ(at(-0.75f, image::Extension::Mirror), 1.0f);
  EXPECT_EQ(image.at(1.25f, 0.5f, image::Interpolation::Closest, image::Extension::Clip), Vec4(0.0f));
  EXPECT_EQ(at(0.75f, image::Extension::Clip), 1.0f);
}

TEST(ImageLookup, Linear) {
  const StoredImage image = black_and_white();
  const auto at = [&](float u, image::Extension e) { return image.at(u, 0.5f, image::Interpolation::Linear, e).x; };
  EXPECT_NEAR(at(0.5f, image::Extension::Repeat), 0.5f, 1e-6f);
  EXPECT_NEAR(at(0.25f, image::Extension::Repeat), 0.0f, 1e-6f);
  EXPECT_NEAR(at(0.375f, image::Extension::Extend), 0.25f, 1e-6f);
  EXPECT_NEAR(at(0.0f, image::Extension::Repeat), 0.5f, 1e-6f);
  EXPECT_NEAR(at(0.0f, image::Extension::Extend), 0.0f, 1e-6f);
  EXPECT_NEAR(at(0.0f, image::Extension::Mirror), 0.0f, 1e-6f);
}

// Regression: clipped images ended abruptly, where Cycles interpolates towards the empty surroundings.
TEST(ImageLookup, BordersOfClippedImagesFade) {
  const StoredImage image = store_source(rgba_source({255, 255, 255, 255}, GRADUS_ALPHA_STRAIGHT, "Non-Color"));
  const auto at = [&](float u, image::Interpolation i) { return image.at(u, 0.5f, i, image::Extension::Clip); };
  EXPECT_EQ(at(0.5f, image::Interpolation::Linear), Vec4(1.0f));
  EXPECT_EQ(at(0.0f, image::Interpolation::Linear), Vec4(0.5f));
  EXPECT_EQ(at(-0.25f, image::Interpolation::Linear), Vec4(0.25f));
  EXPECT_EQ(at(1.25f, image::Interpolation::Linear), Vec4(0.25f));
  EXPECT_EQ(at(1.5f, image::Interpolation::Linear), Vec4(0.0f));
  const float middle = 4.0f / 6.0f;
  EXPECT_NEAR(at(0.5f, image::Interpolation::Cubic).w, middle * middle, 1e-6f);
  EXPECT_NEAR(at(1.5f, image::Interpolation::Cubic).w, middle / 6.0f, 1e-6f);
  EXPECT_EQ(at(0.0f, image::Interpolation::Closest), Vec4(1.0f));
  EXPECT_EQ(at(-0.01f, image::Interpolation::Closest), Vec4(0.0f));
  EXPECT_EQ(at(1e9f, image::Interpolation::Linear), Vec4(0.0f));
}

TEST(ImageLookup, CubicWeightsSumToOne) {
  const StoredImage image = black_and_white();
  for (float u = -1.0f; u < 2.0f; u += 0.1f) {
    const float a = image.at(u, 0.5f, image::Interpolation::Cubic, image::Extension::Repeat).x;
    const float b = image.at(u + 0.5f, 0.5f, image::Interpolation::Cubic, image::Extension::Repeat).x;
    EXPECT_NEAR(a + b, 1.0f, 1e-5f);
  }
}

TEST(ImageLookup, OddCoordinates) {
  const StoredImage image = black_and_white();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float u : {kNan, kInfinity, -kInfinity, 1e30f, -1e30f, 3e9f}) {
    for (const image::Extension e :
         {image::Extension::Repeat, image::Extension::Extend, image::Extension::Clip, image::Extension::Mirror}) {
      for (const image::Interpolation i :
           {image::Interpolation::Linear, image::Interpolation::Closest, image::Interpolation::Cubic}) {
        EXPECT_TRUE(is_finite(image.at(u, u, i, e).x));
      }
    }
  }
}

TEST(ImageLookup, SrgbIsExact) {
  for (const int value : {0, 5, 10, 11, 64, 128, 200, 255}) {
    const uint8_t v = static_cast<uint8_t>(value);
    const StoredImage image = store_source(rgba_source({v, v, v, 255}, GRADUS_ALPHA_STRAIGHT, "sRGB"));
    EXPECT_NEAR(image.at(0.5f, 0.5f).x, image::srgb_to_linear(static_cast<float>(value) / 255.0f), 2e-6f);
    const StoredImage png = store_encoded(make_png(
        4, 4, [&](float, float) { return Vec4(Rgb(static_cast<float>(value) / 255.0f), 1.0f); }, {16, 3, false}));
    EXPECT_NEAR(png.at(0.5f, 0.5f).x, image::srgb_to_linear(static_cast<float>(value) / 255.0f), 6e-4f);
  }
}

TEST(ImageLookup, AlphaModes) {
  const std::vector<uint8_t> half_red = {255, 0, 0, 128};
  const float a = 128.0f / 255.0f;
  const auto at = [&](uint32_t mode, bool unassociate) {
    const StoredImage image = store_source(rgba_source(half_red, mode, "Non-Color"));
    EXPECT_EQ(image.store.has_alpha(image.index), mode != GRADUS_ALPHA_NONE);
    return image.store.lookup(image.index, Vec2(0.5f), image::Interpolation::Closest, image::Extension::Repeat,
                              unassociate);
  };
  EXPECT_NEAR(at(GRADUS_ALPHA_STRAIGHT, false).x, a, 1e-6f);
  EXPECT_NEAR(at(GRADUS_ALPHA_STRAIGHT, true).x, 1.0f, 1e-6f);
  EXPECT_NEAR(at(GRADUS_ALPHA_STRAIGHT, true).w, a, 1e-6f);
  EXPECT_NEAR(at(GRADUS_ALPHA_PREMULTIPLIED, false).x, 1.0f, 1e-6f);
  EXPECT_NEAR(at(GRADUS_ALPHA_CHANNEL_PACKED, false).x, 1.0f, 1e-6f);
  EXPECT_NEAR(at(GRADUS_ALPHA_CHANNEL_PACKED, false).w, a, 1e-6f);
  EXPECT_EQ(at(GRADUS_ALPHA_NONE, false), Vec4(1, 0, 0, 1));
}

// Regression: only some texels of a large image were checked (every seventh, for example): a small transparent area was
// missed, and the material taken for opaque.
TEST(ImageLookup, OneTransparentTexelOfALargeImageCounts) {
  constexpr uint32_t kSide = 2048;
  std::vector<uint8_t> pixels(size_t{kSide} * kSide * 4, 255);
  image::ImageSource source = rgba_source({255, 255, 255, 255}, GRADUS_ALPHA_STRAIGHT, "Non-Color");
  source.tiles[0].width = source.tiles[0].height = kSide;
  source.tiles[0].data = pixels;
  const StoredImage opaque = store_source(source);
  EXPECT_FALSE(opaque.store.has_alpha(opaque.index));
  source.tiles[0].data[4 * 7 + 3] = 254;
  const StoredImage holed = store_source(source);
  EXPECT_TRUE(holed.store.has_alpha(holed.index));
}

TEST(ImageLookup, FloatPixelsBottomRowFirst) {
  const float pixels[8] = {1, 2, 3, 1, 4, 5, 6, 1};
  GradusImageTile tile{};
  tile.struct_size = sizeof(tile);
  tile.source = GRADUS_IMAGE_FLOAT;
  tile.width = 1;
  tile.height = 2;
  tile.data = pixels;
  tile.data_size = sizeof(pixels);
  GradusImage desc{};
  desc.struct_size = sizeof(desc);
  desc.alpha_mode = GRADUS_ALPHA_PREMULTIPLIED;
  desc.tile_count = 1;
  desc.tiles = &tile;
  const StoredImage image = store_source(image::copy_image_source(desc));
  EXPECT_EQ(image.at(0.5f, 0.25f), Vec4(1, 2, 3, 1));
  EXPECT_EQ(image.at(0.5f, 0.75f), Vec4(4, 5, 6, 1));
  tile.data_size = 4;
  EXPECT_THROW(image::copy_image_source(desc), Error);
}

TEST(ImageLookup, NonFiniteTexelsAreBlack) {
  image::ImageSource source;
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_FLOAT;
  source.tiles[0].width = source.tiles[0].height = 1;
  const float pixel[4] = {kInfinity, 1.0f, 1.0f, 1.0f};
  const uint8_t* bytes = reinterpret_cast<const uint8_t*>(pixel);
  source.tiles[0].data.assign(bytes, bytes + sizeof(pixel));
  EXPECT_EQ(store_source(source).at(0.5f, 0.5f), Vec4(0.0f));
}

TEST(ImageLookup, UdimTiles) {
  image::ImageSource source;
  source.color_space = "Non-Color";
  for (const uint32_t number : {1001u, 1002u, 1011u}) {
    image::ImageSource::Tile tile;
    tile.number = number;
    tile.source = GRADUS_IMAGE_BYTE;
    tile.width = tile.height = 1;
    tile.data = {static_cast<uint8_t>(number - 1000), 0, 0, 255};
    source.tiles.push_back(tile);
  }
  const StoredImage image = store_source(source);
  EXPECT_NEAR(image.at(0.5f, 0.5f).x * 255.0f, 1.0f, 1e-4f);
  EXPECT_NEAR(image.at(1.5f, 0.5f).x * 255.0f, 2.0f, 1e-4f);
  EXPECT_NEAR(image.at(0.5f, 1.5f).x * 255.0f, 11.0f, 1e-4f);
  EXPECT_EQ(image.at(5.5f, 0.5f), Vec4(1, 0, 1, 1));
  EXPECT_EQ(image.at(-1.5f, 0.5f), Vec4(1, 0, 1, 1));
  EXPECT_NEAR(image.at(-0.5f, 1.5f).x * 255.0f, 11.0f, 1e-4f);  // as in Cycles, which rounds towards 0
  EXPECT_NEAR(image.at(1.5f, -0.5f).x * 255.0f, 2.0f, 1e-4f);
}

TEST(ImageLookup, MeanIsLinear) {
  EXPECT_NEAR(black_and_white().store.mean(0).x, 0.5f, 1e-6f);
  const StoredImage grey = store_source(rgba_source({128, 128, 128, 255}, GRADUS_ALPHA_STRAIGHT, "sRGB"));
  EXPECT_NEAR(grey.store.mean(0).x, image::srgb_to_linear(128.0f / 255.0f), 1e-5f);
}

TEST(ImageLookup, KeysReplaceAndKeepTheirIndex) {
  const image::ColorManager color("", nullptr);
  image::ImageStore store;
  const auto red = image::load_image(rgba_source({255, 0, 0, 255}, GRADUS_ALPHA_STRAIGHT, ""), color);
  const auto green = image::load_image(rgba_source({0, 255, 0, 255}, GRADUS_ALPHA_STRAIGHT, ""), color);
  const uint32_t first = store.add(10, red);
  const uint32_t second = store.add(11, green);
  EXPECT_NE(first, second);
  EXPECT_EQ(store.add(10, green), first);
  EXPECT_EQ(store.index_of(10), first);
  EXPECT_EQ(store.index_of(12), image::ImageStore::kNone);
  EXPECT_EQ(store.lookup(first, Vec2(0.5f), image::Interpolation::Linear, image::Extension::Repeat), Vec4(0, 1, 0, 1));
  EXPECT_EQ(store.lookup(image::ImageStore::kNone, Vec2(0.5f), image::Interpolation::Linear, image::Extension::Repeat),
            Vec4(1, 0, 1, 1));
}

}  // namespace
}  // namespace gradus::test::image_lookup_test
