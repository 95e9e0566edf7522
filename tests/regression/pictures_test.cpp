// M1, M2: pictures are as they were stored in pictures.json.
//
// Every change: their block means, within the noise, so that a change of sampling may pass and a change of the light may not. In full:
// their bits, on the kind of machine and compiler that stored them. Where pictures are meant to change, they are stored anew:
//   GRADUS_STORE_PICTURES=1 build/tests/gradus_regression_tests
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "regression/pictures.h"
#include "support/statistics.h"

namespace gradus::regression {
namespace {

using nlohmann::json;

const char* const kFile = GRADUS_SOURCE_DIR "/tests/regression/pictures.json";
constexpr uint32_t kStoredSeeds = 16, kStoredSamples = 8, kSeeds = 4, kSamples = 2;

// Libraries choose their code by the processor.
std::string machine() {
  std::ifstream file("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(file, line)) {
    if (line.rfind("model name", 0) == 0) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  }
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__)
  return name + ", " + __VERSION__;
#else
  return name + ", " + __VERSION__ + ", another kind of build";
#endif
}

std::string bits(const Picture& picture) {
  const std::vector<float> image = render(picture, 2, 0);
  uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (size_t i = 0; i < image.size() * sizeof(float); ++i) {
    hash = (hash ^ reinterpret_cast<const unsigned char*>(image.data())[i]) * 1099511628211u;
  }
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

test::Moments measure(const Picture& picture, uint32_t seeds, uint32_t samples) {
  test::Moments moments;
  for (uint32_t seed = 0; seed < seeds; ++seed) moments.add(block_means(render(picture, samples, seed + 1)));
  return moments;
}

json stored() {
  std::ifstream file(kFile);
  return json::parse(file);
}

json measured(const Picture& picture, const json& before) {
  json entry;
  entry["bits"] = bits(picture);
  if (before.contains(picture.name) && before[picture.name]["bits"] == entry["bits"]) return before[picture.name];
  const test::Moments moments = measure(picture, kStoredSeeds, kStoredSamples);
  for (size_t i = 0; i < moments.size(); ++i) {
    // Whole numbers of 1e-5: short, and far below the noise.
    entry["mean"].push_back(std::lround(1e5 * moments.mean(i)));
    entry["error"].push_back(std::lround(1e5 * std::sqrt(moments.variance_of_mean(i))));
  }
  return entry;
}

// A picture a line, so that one sees which have changed. The others are kept.
void store() {
  const json before = std::ifstream(kFile).good() ? stored()["pictures"] : json::object();
  std::ofstream file(kFile);
  file << "{\"machine\": " << json(machine()) << ",\n\"pictures\": {";
  const char* separator = "\n";
  for (const Picture& picture : pictures()) {
    file << separator << json(picture.name) << ": " << measured(picture, before);
    separator = ",\n";
  }
  file << "\n}}\n";
}

class M1_Pictures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (std::getenv("GRADUS_STORE_PICTURES") != nullptr) store();
  }
};

// A5's rule for blocks: 99.75 % within Šidák's bound of all of them. Their mean within 4 deviations.
TEST_F(M1_Pictures, M2_LookAsStored) {
  const json all = stored();
  ASSERT_EQ(all["pictures"].size(), pictures().size());
  const double scale = std::sqrt(double(kStoredSeeds * kStoredSamples) / (kSeeds * kSamples));
  for (const Picture& picture : pictures()) {
    const json& entry = all["pictures"].at(picture.name);
    const test::Moments moments = measure(picture, kSeeds, kSamples);
    ASSERT_EQ(entry["mean"].size(), moments.size());
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
    EXPECT_LE(double(off), 0.0025 * double(moments.size())) << picture.name;
    // Channels of a block come from the same paths.
    EXPECT_LE(std::fabs(sum), 4.0 * std::sqrt(3.0 * variance)) << picture.name;
  }
}

TEST_F(M1_Pictures, HaveTheStoredBits) {
  if (!test::full_run()) GTEST_SKIP() << "in make test-full only: any change of sampling changes them";
  const json all = stored();
  if (all["machine"] != machine()) GTEST_SKIP() << "stored on " << all["machine"];
  for (const Picture& picture : pictures()) EXPECT_EQ(bits(picture), all["pictures"].at(picture.name)["bits"]) << picture.name;
}

}  // namespace
}  // namespace gradus::regression
