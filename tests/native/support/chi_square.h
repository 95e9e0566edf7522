// Chi-square test of a sampler against its density, like that of pbrt (bsdfs_test.cpp): the same 80×160 grid over the
// sphere and the same tolerance.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/types.h"

namespace gradus::test {

struct ChiSquareResult {
  double statistic = 0.0;
  double p_value = 0.0;
  int degrees_of_freedom = 0;
  double mass = 0.0;                // integral of the density
  size_t zero_density_samples = 0;  // samples in cells where the density is 0
  bool passed = false;
  std::string text;  // reason of a failure, or the numbers
};

// Number of tests in a run of the suite: Šidák's correction of the 1 % level.
inline constexpr int kTestsPerRun = 200;

// observed: counts per cell; expected: sample count times the density's integral. Cells with an expectation under 5 are
// pooled. invalid: samples outside of the domain. A lost sample (the sampler returned false) is missing in `observed`;
// the density then has a mass below 1.
ChiSquareResult chi_square_counts(const std::vector<double>& observed, const std::vector<double>& expected,
                                  size_t sample_count, size_t invalid, int tests = kTestsPerRun);

struct ChiSquareOptions {
  size_t samples = 100000;
  int rows = 80;      // of the polar angle around `axis`
  int columns = 160;  // of the azimuth
  Vec3 axis = Vec3(0, 0, 1);
  uint32_t seed = 1;
  int tests = kTestsPerRun;
};
// sample: maps two 2-D random values in [0,1)⁴ to a unit direction; false: lost. pdf: density in solid angle.
ChiSquareResult chi_square_sphere(const std::function<bool(const Vec2& u, const Vec2& v, Vec3* direction)>& sample,
                                  const std::function<double(const Vec3&)>& pdf, const ChiSquareOptions& options = {});

// Independent values in [0, 1): PCG (O'Neill 2014).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 6364136223846793005ull + 1442695040888963407ull) { next(); }
  uint32_t next() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005ull + 1442695040888963407ull;
    const uint32_t x = static_cast<uint32_t>(((old >> 18u) ^ old) >> 27u);
    const uint32_t r = static_cast<uint32_t>(old >> 59u);
    return (x >> r) | (x << ((32u - r) & 31u));
  }
  float get() { return static_cast<float>(next() >> 8) * 0x1p-24f; }
  Vec2 get2() {
    const float x = get();
    return Vec2(x, get());
  }

 private:
  uint64_t state_;
};

}  // namespace gradus::test
