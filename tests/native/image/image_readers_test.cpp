// F3: every layout is read correctly, with v up, and wrong headers are refused at once.
#include <chrono>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "image/image_test_support.h"

namespace gradus::test::image_readers_test {
namespace {

void expect_color(const StoredImage& image, float u, float v, const Vec4& expected, float tolerance) {
  const Vec4 c = image.at(u, v);
  for (int i = 0; i < 4; i++) {
    EXPECT_NEAR(c[i], expected[i], tolerance) << "channel " << i << " at " << u << ' ' << v;
  }
}

void expect_four_colors(const FileBytes& file, float tolerance = 1e-3f) {
  const StoredImage image = store_encoded(file, "Linear");
  EXPECT_TRUE(image.store.warnings().empty()) << image.store.warnings()[0];
  for (const float x : {0.1f, 0.4f, 0.6f, 0.9f}) {
    for (const float y : {0.1f, 0.4f, 0.6f, 0.9f}) {
      expect_color(image, x, y, four_colors(x, y), tolerance);
    }
  }
}

void expect_grey(const FileBytes& file, float tolerance = 1e-3f) {
  const StoredImage image = store_encoded(file, "Linear");
  EXPECT_TRUE(image.store.warnings().empty()) << image.store.warnings()[0];
  for (const float x : {0.1f, 0.9f}) {
    for (const float y : {0.1f, 0.9f}) {
      const float g = four_colors(x, y).x;
      expect_color(image, x, y, Vec4(g, g, g, 1.0f), tolerance);
    }
  }
}

TEST(F3_ImageReaders, Png) {
  for (const int bits : {8, 16}) {
    for (const bool interlaced : {false, true}) {
      expect_four_colors(make_png(30, 20, four_colors, {bits, 4, interlaced}));
      expect_four_colors(make_png(31, 20, four_colors, {bits, 3, interlaced}));
      expect_grey(make_png(30, 20, four_colors, {bits, 2, interlaced}));
      expect_grey(make_png(30, 20, four_colors, {bits, 1, interlaced}));
    }
  }
  expect_four_colors(make_palette_png(32, 20));
}

TEST(F3_ImageReaders, Jpeg) {
  expect_four_colors(make_jpeg(64, 64, four_colors), 0.02f);
  expect_four_colors(make_jpeg(64, 64, four_colors, false, true), 0.02f);
  expect_grey(make_jpeg(64, 64, four_colors, true), 0.02f);
}

TEST(F3_ImageReaders, Tiff) {
  constexpr int kLzw = 5;
  constexpr int kDeflate = 8;
  for (const int bits : {8, 16, 32}) {
    for (const bool tiled : {false, true}) {
      for (const bool separate : {false, true}) {
        expect_four_colors(make_tiff(36, 20, four_colors, {bits, 3, tiled, separate, kLzw}));
        expect_four_colors(make_tiff(36, 20, four_colors, {bits, 4, tiled, separate, kDeflate}));
      }
      expect_grey(make_tiff(36, 20, four_colors, {bits, 1, tiled, false, 1}));
      expect_grey(make_tiff(36, 20, four_colors, {bits, 2, tiled, false, 1}));
    }
  }
}

TEST(F3_ImageReaders, Exr) {
  for (const int type : {0, 1, 2}) {
    for (const bool tiled : {false, true}) {
      ExrOptions options;
      options.type = type;
      options.tiled = tiled;
      expect_four_colors(make_exr(36, 20, four_colors, options));
      options.channels = std::string("RGB");
      expect_four_colors(make_exr(36, 20, four_colors, options));
      options.channels = std::string("RGBAZ");
      expect_four_colors(make_exr(36, 20, four_colors, options));
      options.channels = std::string("Y");
      expect_grey(make_exr(36, 20, four_colors, options));
      options.channels = std::string("Z");
      expect_grey(make_exr(36, 20, four_colors, options));
    }
  }
}

TEST(F3_ImageReaders, ExrLayouts) {
  ExrOptions options;
  for (int compression = 0; compression <= 5; compression++) {
    options.compression = compression;
    expect_four_colors(make_exr(36, 50, four_colors, options));
  }
  options.bottom_up = true;
  expect_four_colors(make_exr(36, 50, four_colors, options));
  options.offset_x = -7;
  options.offset_y = 13;
  expect_four_colors(make_exr(36, 50, four_colors, options));
  options = {};
  options.multipart = true;
  expect_four_colors(make_exr(36, 50, four_colors, options));
  options = {};
  options.layer = std::string("View Layer.Combined.");
  expect_four_colors(make_exr(36, 50, four_colors, options));
}

TEST(F3_ImageReaders, Hdr) {
  expect_four_colors(make_hdr(36, 20, four_colors), 0.01f);
  expect_four_colors(make_hdr(36, 20, four_colors, false), 0.01f);
  const StoredImage bright =
      store_encoded(make_hdr(36, 20, [](float, float) { return Vec4(1e6f, 2e6f, 3.0f, 1.0f); }), "Linear");
  EXPECT_NEAR(bright.at(0.5f, 0.5f).x, 1e6f, 1e4f);
  EXPECT_NEAR(bright.at(0.5f, 0.5f).y, 2e6f, 1e4f);
}

TEST(F3_ImageReaders, DeepIsRefusedByName) {
  const StoredImage image = store_encoded(make_deep_exr());
  ASSERT_EQ(image.store.warnings().size(), 1u);
  EXPECT_NE(image.store.warnings()[0].find("deep"), std::string::npos) << image.store.warnings()[0];
}

// Returns the peak of the process's memory, in bytes.
size_t peak_memory() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word == "VmHWM:") {
      size_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  }
  return 0;
}

void put_big_endian(FileBytes* file, size_t position, uint32_t value) {
  for (unsigned i = 0; i < 4; i++) {
    (*file)[position + i] = static_cast<uint8_t>(value >> (24 - 8 * i));
  }
}

void expect_refused(const FileBytes& file, const std::string& what) {
  const size_t before = peak_memory();
  const auto start = std::chrono::steady_clock::now();
  const StoredImage image = store_encoded(file);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ASSERT_EQ(image.store.warnings().size(), 1u) << what;
  EXPECT_EQ(image.at(0.3f, 0.3f), Vec4(1, 0, 1, 1)) << what;
  EXPECT_LT(seconds, 0.1) << what;
  EXPECT_LT(peak_memory() - before, 64u << 20) << what;
}

TEST(F3_ImageReaders, FalseSizesAreRefused) {
  constexpr uint32_t kHuge = 1u << 30;
  FileBytes png = make_png(16, 16, four_colors);
  put_big_endian(&png, 16, kHuge);
  put_big_endian(&png, 20, kHuge);
  expect_refused(png, "PNG");
  // The maximum size of PNG files, but with hardly any data; the checksum of the header is wrong, too.
  put_big_endian(&png, 16, 30000);
  put_big_endian(&png, 20, 30000);
  expect_refused(png, "PNG of 30000");

  FileBytes jpeg = make_jpeg(16, 16, four_colors);
  for (size_t i = 0; i + 9 < jpeg.size(); i++) {
    if (jpeg[i] == 0xff && jpeg[i + 1] == 0xc0) {
      std::fill(jpeg.begin() + static_cast<ptrdiff_t>(i) + 5, jpeg.begin() + static_cast<ptrdiff_t>(i) + 9,
                uint8_t{0xff});
    }
  }
  expect_refused(jpeg, "JPEG");

  FileBytes exr = make_exr(16, 16, four_colors);
  const std::string name = "dataWindow";
  const auto found = std::search(exr.begin(), exr.end(), name.begin(), name.end());
  ASSERT_NE(found, exr.end());
  const int32_t box[4] = {0, 0, static_cast<int32_t>(kHuge - 1), static_cast<int32_t>(kHuge - 1)};
  std::memcpy(&*found + name.size() + 1 + 6 + 4, box, sizeof(box));
  expect_refused(exr, "EXR");
  const int32_t wide[4] = {0, 0, 29999, 29999};
  std::memcpy(&*found + name.size() + 1 + 6 + 4, wide, sizeof(wide));
  expect_refused(exr, "EXR of 30000");

  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 999999999 +X 999999999\n";
  expect_refused(FileBytes(hdr.begin(), hdr.end()), "HDR");
  const std::string wide_hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\nabcdefgh";
  expect_refused(FileBytes(wide_hdr.begin(), wide_hdr.end()), "HDR of 30000");

  FileBytes tiff = make_tiff(16, 16, four_colors);
  uint32_t directory = 0;
  std::memcpy(&directory, tiff.data() + 4, 4);
  uint16_t entries = 0;
  std::memcpy(&entries, tiff.data() + directory, 2);
  for (uint16_t i = 0; i < entries; i++) {
    uint8_t* entry = tiff.data() + directory + 2 + 12 * i;
    uint16_t tag = 0;
    std::memcpy(&tag, entry, 2);
    if (tag == 256 || tag == 257) {
      const uint16_t type_long = 4;
      std::memcpy(entry + 2, &type_long, 2);
      std::memcpy(entry + 8, &kHuge, 4);
    }
  }
  expect_refused(tiff, "TIFF");
}

}  // namespace
}  // namespace gradus::test::image_readers_test
