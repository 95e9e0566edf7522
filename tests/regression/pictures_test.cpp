// Compares pictures with those stored in pictures.json. On any machine their block means must agree within the noise.
// On a machine with a processor, compiler and libraries that have stored them their bits must agree, too, so that every
// change is noticed. Pictures that differ are written to the build folder. After an intended change, or to add the bits
// of another kind of machine, store them with
//   GRADUS_STORE_PICTURES=1 build/tests/gradus_regression_tests
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <embree3/rtcore.h>
#include <gnu/libc-version.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "film_io/image_exr.h"
#include "regression/artefacts.h"
#include "regression/pictures.h"
#include "support/statistics.h"

namespace gradus::regression::pictures_test {
namespace {

using nlohmann::json;

const char* const kFile = GRADUS_SOURCE_DIR "/tests/regression/pictures.json";
constexpr uint32_t kStoredSeeds = 16, kStoredSamples = 8, kSeeds = 4, kSamples = 2;
// Minimum brightness that is assumed for the neighbours of a pixel, so that single lit pixels of a dark region are no
// outliers.
constexpr float kDark = 0.01f;

// Returns the value of the first line of /proc/cpuinfo that begins with `key`.
std::string processor(const std::string& key) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key, 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown " + key;
}

// Returns a text with all that the bits depend on: the compiler, and the processor by which libraries choose their
// code. These are the functions of the C library and Embree's kernels, whose approximate reciprocals differ between
// processors.
std::string machine() {
  std::string name = processor("model name");
  std::istringstream flags(processor("flags"));
  for (std::string flag; flags >> flag;) {
    if (flag == "avx2" || flag == "fma" || flag == "avx512f" || flag == "avx512vl") name += " " + flag;
  }
  name +=
      std::string(", glibc ") + gnu_get_libc_version() + ", Embree " + RTC_VERSION_STRING + ", compiler " + __VERSION__;
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__)
  return name;
#else
  return name + ", another kind of build";
#endif
}

// Returns a hash of the bits of an image in hexadecimal digits.
std::string bits(const std::vector<float>& image) {
  uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (size_t i = 0; i < image.size() * sizeof(float); ++i) {
    hash = (hash ^ reinterpret_cast<const unsigned char*>(image.data())[i]) * 1099511628211u;
  }
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

// Renders the image whose bits are stored.
std::vector<float> render_stored(const Picture& picture) { return render(picture, 2, 1); }

// Mean and variance of blocks and pixels over several seeds.
struct Measured {
  test::Moments blocks, pixels;
};

Measured measure(const Picture& picture, uint32_t seeds, uint32_t samples) {
  Measured measured;
  for (uint32_t seed = 0; seed < seeds; ++seed) {
    const std::vector<float> rgba = render(picture, samples, seed + 1);
    measured.pixels.add(rgba);
    measured.blocks.add(block_means(rgba));
  }
  return measured;
}

std::vector<float> means(const test::Moments& moments) {
  std::vector<float> result(moments.size());
  for (size_t i = 0; i < result.size(); ++i) result[i] = float(moments.mean(i));
  return result;
}

// Returns the maximum of a channel over the eight neighbours of a pixel.
float brightest_neighbour(const std::vector<float>& rgba, int x, int y, size_t channel) {
  float brightest = 0.0f;
  for (int v = std::max(0, y - 1); v < std::min(int(kHeight), y + 2); ++v) {
    for (int u = std::max(0, x - 1); u < std::min(int(kWidth), x + 2); ++u) {
      if (u != x || v != y) brightest = std::max(brightest, rgba[4 * (size_t(v) * kWidth + size_t(u)) + channel]);
    }
  }
  return brightest;
}

// Describes the first pixel that is not finite or much brighter than its neighbours. Returns "" if there is none.
std::string flaw(const std::vector<float>& rgba) {
  for (int y = 0; y < int(kHeight); ++y) {
    for (int x = 0; x < int(kWidth); ++x) {
      const std::string where = " at " + std::to_string(x) + ", " + std::to_string(y);
      for (size_t c = 0; c < 4; ++c) {
        const float value = rgba[4 * (size_t(y) * kWidth + size_t(x)) + c];
        if (!std::isfinite(value)) return "not finite" + where;
        if (value > 100.0f * std::max(brightest_neighbour(rgba, x, y, c), kDark))
          return "100 times its neighbours" + where;
      }
    }
  }
  return "";
}

json stored() {
  std::ifstream file(kFile);
  return json::parse(file);
}

// Returns the entry of a picture for pictures.json. If this machine has stored the same bits before, that is the entry
// from before, and if it has stored none, its bits are added to that. Otherwise the picture has changed, and the bits
// of other machines are no longer known.
json measured(const Picture& picture, const json& before) {
  const std::string own = bits(render_stored(picture));
  if (before.contains(picture.name)) {
    json entry = before[picture.name];
    if (entry["bits"].emplace(machine(), own).first.value() == own) return entry;
  }
  json entry;
  entry["bits"][machine()] = own;
  const uint32_t samples = picture.is_biased ? kSamples : kStoredSamples;
  const test::Moments moments = measure(picture, kStoredSeeds * kStoredSamples / samples, samples).blocks;
  for (size_t i = 0; i < moments.size(); ++i) {
    // Integers in units of 1e-5 keep the file short. Their rounding is far below the noise.
    entry["mean"].push_back(std::lround(1e5 * moments.mean(i)));
    entry["error"].push_back(std::lround(1e5 * std::sqrt(moments.variance_of_mean(i))));
  }
  return entry;
}

// Writes pictures.json with one picture per line, so that a diff shows which have changed. The entries of pictures with
// unchanged bits stay.
void store() {
  const json before = std::ifstream(kFile).good() ? stored() : json::object();
  std::ofstream file(kFile);
  const char* separator = "{\n";
  for (const Picture& picture : pictures()) {
    file << separator << json(picture.name) << ": " << measured(picture, before);
    separator = ",\n";
  }
  file << "\n}\n";
}

class M1_Pictures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (std::getenv("GRADUS_STORE_PICTURES") != nullptr) store();
  }
};

std::vector<float> means_of(const json& entry) {
  std::vector<float> means;
  for (const json& mean : entry["mean"]) means.push_back(1e-5f * float(mean));
  return means;
}

// Returns whether 99.75 % of the block means lie within Šidák's bound for all blocks, taken as 5 standard deviations
// plus 0.2 % and 1e-4, of the stored ones, and the sum of their differences within 4 standard deviations.
bool looks_as_stored(const test::Moments& moments, const json& entry) {
  const double scale = std::sqrt(double(kStoredSeeds * kStoredSamples) / (kSeeds * kSamples));
  size_t off = 0;
  double sum = 0.0, variance = 0.0;
  for (size_t i = 0; i < moments.size(); ++i) {
    const double mean = 1e-5 * double(entry["mean"][i]), error = 1e-5 * double(entry["error"][i]);
    const double noise = std::sqrt(error * error * (1.0 + scale * scale) + moments.variance_of_mean(i)),
                 difference = moments.mean(i) - mean;
    off += std::fabs(difference) > 5.0 * noise + 0.002 * std::fabs(mean) + 1e-4 ? 1 : 0;
    sum += difference;
    variance += noise * noise;
  }
  // The factor 3 is there because the three channels of a block come from the same paths and are correlated.
  return double(off) <= 0.0025 * double(moments.size()) && std::fabs(sum) <= 4.0 * std::sqrt(3.0 * variance);
}

TEST_F(M1_Pictures, M2_LookAsStored) {
  const json all = stored();
  ASSERT_EQ(all.size(), pictures().size());
  for (const Picture& picture : pictures()) {
    const json& entry = all.at(picture.name);
    const Measured measured = measure(picture, kSeeds, kSamples);
    ASSERT_EQ(entry["mean"].size(), measured.blocks.size());
    const std::vector<float> mean = means(measured.pixels);
    EXPECT_EQ(flaw(mean), "") << keep(picture.name, "", means_of(entry), mean);
    EXPECT_TRUE(looks_as_stored(measured.blocks, entry)) << keep(picture.name, "", means_of(entry), mean);
  }
}

TEST_F(M1_Pictures, HaveTheStoredBits) {
  const json all = stored();
  size_t compared = 0;
  for (const Picture& picture : pictures()) {
    const json& entry = all.at(picture.name);
    if (!entry["bits"].contains(machine())) continue;
    const std::string expected = entry["bits"][machine()];
    const std::vector<float> rgba = render_stored(picture);
    EXPECT_EQ(flaw(rgba), "") << picture.name;
    EXPECT_EQ(bits(rgba), expected) << keep(picture.name, expected, means_of(entry), rgba);
    if (bits(rgba) == expected) save_reference(expected, rgba);
    ++compared;
  }
  if (compared < all.size()) {
    GTEST_SKIP() << "no bits of " << machine() << " are stored for " << all.size() - compared << " of " << all.size()
                 << " pictures";
  }
}

TEST(M1_Artefacts, ReportWhatDiffersAndWhere) {
  const std::filesystem::path folder = GRADUS_BINARY_DIR "/pictures", stored = folder / "stored/a test.exr";
  std::vector<float> rgba(size_t(kWidth) * kHeight * 4, 0.5f);
  const std::vector<float> means = block_means(rgba);
  EXPECT_NE(keep("a test", "a test", means, rgba).find("relMSE of blocks 0;"), std::string::npos);
  save_reference("a test", rgba);
  rgba[0] = 2.0f;
  const std::string text = keep("a test", "a test", means, rgba);
  EXPECT_NE(text.find("relMSE of pixels 0.0003"), std::string::npos)
      << text;  // 1.5² / (0.001 + 0.5²) in one of 27648 values
  EXPECT_NE(text.find((folder / "a test.png").string()), std::string::npos) << text;
  EXPECT_GT(std::filesystem::file_size(folder / "a test.png"), 100u);
  EXPECT_EQ(film_io::load_rgb(folder / "a test.exr", "").rgb[0], 2.0f);
  for (const std::filesystem::path& file : {folder / "a test.png", folder / "a test.exr", stored})
    std::filesystem::remove(file);
}

TEST(M2_Pixels, SpikesAndValuesThatAreNotFiniteAreDetected) {
  std::vector<float> rgba(size_t(kWidth) * kHeight * 4, 0.5f);
  EXPECT_EQ(flaw(rgba), "");
  const size_t last = rgba.size() - 4;
  rgba[last] = 60.0f;
  EXPECT_EQ(flaw(rgba), "100 times its neighbours at 127, 71");
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    rgba[last] = value;
    EXPECT_EQ(flaw(rgba), "not finite at 127, 71");
  }
}

}  // namespace
}  // namespace gradus::regression::pictures_test
