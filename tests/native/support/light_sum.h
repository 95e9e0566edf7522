// The sum of light passes, as a compositor computes it.
#pragma once

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gradus/gradus.h"

namespace gradus::test {

// Returns Σ Color · (Direct + Indirect) + Emission + Environment, RGB. read: returns a pass, three values for each
// pixel.
template <class Read>
std::vector<float> sum_of_light(const Read& read) {
  std::vector<float> sum = read(GRADUS_PASS_EMISSION);
  const std::vector<float> environment = read(GRADUS_PASS_ENVIRONMENT);
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += environment[i];
  for (uint32_t direct : {GRADUS_PASS_DIFFUSE_DIRECT, GRADUS_PASS_GLOSSY_DIRECT, GRADUS_PASS_TRANSMISSION_DIRECT}) {
    const std::vector<float> d = read(direct), i = read(direct + 1), c = read(direct + 2);
    for (size_t k = 0; k < sum.size(); ++k) sum[k] += c[k] * (d[k] + i[k]);
  }
  return sum;
}

template <class Read>
void expect_light_to_add_up(const Read& read, const std::vector<float>& rgba) {
  const std::vector<float> sum = sum_of_light(read);
  for (size_t i = 0; i < sum.size(); ++i) {
    const float expected = rgba[i / 3 * 4 + i % 3];
    ASSERT_NEAR(sum[i], expected, 1e-4f * (1.0f + std::fabs(expected))) << "pixel " << i / 3 << " channel " << i % 3;
  }
}

}  // namespace gradus::test
