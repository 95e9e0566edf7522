// F1: missing and unreadable images; F2: damaged files.
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>

#include <gtest/gtest.h>

#include "image/image_test_support.h"
#include "support/chi_square.h"

namespace gradus::test::image_damage_test {
namespace {

void expect_fallback(const StoredImage& image, const std::string& path) {
  EXPECT_EQ(image.at(0.2f, 0.7f), Vec4(1, 0, 1, 1)) << path;
  EXPECT_EQ(image.store.mean(image.index), Rgb(1, 0, 1));
  ASSERT_EQ(image.store.warnings().size(), 1u) << path;
  EXPECT_NE(image.store.warnings()[0].find(path), std::string::npos) << image.store.warnings()[0];
}

TEST(F1_MissingImages, FallbackAndOneWarningWithThePath) {
  expect_fallback(store_file("/nowhere/at/all.png"), "/nowhere/at/all.png");
  expect_fallback(store_file("/tmp"), "/tmp");
  const std::string empty = write_temporary("empty.png", {});
  expect_fallback(store_file(empty), empty);
  const std::string text = write_temporary("text.png", {'h', 'e', 'l', 'l', 'o'});
  expect_fallback(store_file(text), text);
}

TEST(F1_MissingImages, Truncated) {
  const std::pair<std::string, FileBytes> files[] = {
      {"t.png", make_png(64, 64, four_colors)},
      {"t.jpg", make_jpeg(256, 256, [](float x, float y) { return Vec4(x, y, std::abs(std::sin(50 * x * y)), 1); })},
      {"t.tif", make_tiff(64, 64, four_colors)},
      {"t.exr", make_exr(64, 64, four_colors)},
      {"t.hdr", make_hdr(64, 64, four_colors)}};
  for (const auto& [name, bytes] : files) {
    for (const double share : {0.02, 0.3, 0.7}) {
      const FileBytes part(bytes.begin(),
                           bytes.begin() + static_cast<ptrdiff_t>(static_cast<double>(bytes.size()) * share));
      const std::string path = write_temporary(name, part);
      expect_fallback(store_file(path), path);
    }
  }
}

TEST(F1_MissingImages, ContentDecidesNotTheFileName) {
  const StoredImage image = store_file(write_temporary("really_png.jpg", make_png(8, 8, four_colors)));
  EXPECT_TRUE(image.store.warnings().empty());
  EXPECT_EQ(image.at(0.2f, 0.2f), Vec4(1, 0, 0, 1));
}

TEST(F1_MissingImages, NotReadable) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "root reads everything";
  }
  const std::string path = write_temporary("locked.png", make_png(8, 8, four_colors));
  chmod(path.c_str(), 0);
  expect_fallback(store_file(path), path);
}

TEST(F1_MissingImages, PipesDoNotBlock) {
  const std::string path = write_temporary("pipe", {});
  unlink(path.c_str());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  expect_fallback(store_file(path), path);
  unlink(path.c_str());
}

// Damages at most a tenth of the bytes, in a random window or in the first 2,048.
FileBytes damage(const FileBytes& file, Random* random, bool header) {
  FileBytes out = file;
  const size_t window = header ? std::min<size_t>(2048, out.size()) : std::max<size_t>(1, out.size() / 10);
  const size_t first = header ? 0 : random->next() % (out.size() - window + 1);
  const size_t count = 1 + random->next() % std::max<size_t>(1, window / 10);
  for (size_t i = 0; i < count; i++) {
    out[first + random->next() % window] = static_cast<uint8_t>(random->next());
  }
  return out;
}

TEST(F2_ImageFuzz, DamageNeverCrashes) {
  ExrOptions tiled;
  tiled.tiled = true;
  ExrOptions piz;
  piz.compression = 4;
  ExrOptions parts;
  parts.multipart = true;
  const auto pattern = [](float x, float y) { return Vec4(x, y, x * y, 0.5f + 0.5f * x); };
  const FileBytes files[] = {make_png(40, 30, pattern),
                             make_png(40, 30, pattern, {16, 3, true}),
                             make_palette_png(40, 30),
                             make_jpeg(40, 30, pattern),
                             make_jpeg(40, 30, pattern, false, true),
                             make_tiff(40, 30, pattern, {8, 3, false, false, 5}),
                             make_tiff(40, 30, pattern, {16, 4, true, true, 8}),
                             make_exr(40, 30, pattern),
                             make_exr(40, 30, pattern, tiled),
                             make_exr(40, 30, pattern, piz),
                             make_exr(40, 30, pattern, parts),
                             make_hdr(40, 30, pattern)};
  constexpr int rounds = 8000;
  Random random(2024);
  for (int i = 0; i < rounds; i++) {
    const FileBytes bytes = damage(files[static_cast<size_t>(i) % std::size(files)], &random, random.next() % 2 == 0);
    const auto start = std::chrono::steady_clock::now();
    const StoredImage image = store_encoded(bytes);
    EXPECT_TRUE(is_finite(image.at(0.3f, 0.3f).x));
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 5.0) << "round " << i;
  }
}

}  // namespace
}  // namespace gradus::test::image_damage_test
