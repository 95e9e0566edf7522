// The density over directions: its integral, its samples, and its digits.
#include "guide/direction_mixture.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/chi_square.h"

namespace gradus::direction_mixture_test {
namespace {

using guide::DirectionMixture;
using guide::kLobes;
using test::Random;

constexpr float kConcentrations[] = {DirectionMixture::kMinConcentration, 10.0f, DirectionMixture::kMaxConcentration};

Vec3 random_direction(Random* random) {
  const float z = 2.0f * random->get() - 1.0f, r = std::sqrt(1.0f - z * z), phi = 6.2831853f * random->get();
  return glm::normalize(Vec3(r * std::cos(phi), r * std::sin(phi), z));
}

// Returns lobes in random directions. The first has no weight.
DirectionMixture make_mixture(uint64_t seed, float concentration) {
  Random random(seed);
  DirectionMixture m;
  for (size_t i = 0; i < kLobes; ++i) {
    const Vec3 axis = random_direction(&random);
    m.set_axis(i, axis);
    guide::set(i, concentration, &m.concentration);
    guide::set(i, i == 0 ? 0.0f : 0.1f + random.get(), &m.weight);
  }
  m.finish();
  return m;
}

// Returns lobes of all concentrations.
DirectionMixture make_mixed() {
  DirectionMixture m = make_mixture(7, 10.0f);
  for (size_t i = 0; i < kLobes; ++i) guide::set(i, 0.1f * std::pow(2.0f, float(i)), &m.concentration);
  m.finish();
  return m;
}

// Returns one lobe with all weight.
DirectionMixture make_lobe(const Vec3& axis, float concentration) {
  DirectionMixture m = make_mixture(3, concentration);
  for (size_t i = 0; i < kLobes; ++i) guide::set(i, i == 5 ? 1.0f : 0.0f, &m.weight);
  m.set_axis(5, axis);
  m.finish();
  return m;
}

double true_pdf(const DirectionMixture& m, const Vec3& d) {
  double sum = 0.0;
  for (size_t i = 0; i < kLobes; ++i) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(m.axis(i)));
    const double k = guide::get(m.concentration, i);
    const glm::dvec3 off = axis - glm::normalize(glm::dvec3(d));
    sum += guide::get(m.weight, i) * k / (2.0 * std::numbers::pi * (1.0 - std::exp(-2.0 * k))) *
           std::exp(-0.5 * k * glm::dot(off, off));
  }
  return sum;
}

// Integrates the density of a lobe over rings around its axis.
TEST(DirectionMixture, IntegratesToOne) {
  Random random(1);
  for (const float concentration : kConcentrations) {
    const Vec3 axis = random_direction(&random), side = glm::normalize(glm::cross(axis, Vec3(0.3f, 0.2f, -0.9f)));
    const DirectionMixture lobe = make_lobe(axis, concentration);
    constexpr int kRings = 20000;
    double sum = 0.0, before = 0.0;
    for (int i = 0; i < kRings; ++i) {
      // narrow rings where the density is large
      const double angle = std::numbers::pi * std::pow((i + 0.5) / kRings, 3.0);
      const double end = std::cos(std::numbers::pi * std::pow((i + 1.0) / kRings, 3.0));
      const Vec3 d = float(std::cos(angle)) * axis + float(std::sin(angle)) * side;
      sum += lobe.pdf(d) * 2.0 * std::numbers::pi * ((i == 0 ? 1.0 : before) - end);
      before = end;
    }
    EXPECT_NEAR(sum, 1.0, 1e-3) << concentration;
  }
}

TEST(DirectionMixture, SamplesFollowTheDensity) {
  for (int i = 0; i < 4; ++i) {
    const DirectionMixture m = i < 3 ? make_mixture(uint64_t(i) + 1, kConcentrations[i]) : make_mixed();
    test::ChiSquareOptions options;
    options.axis = glm::normalize(Vec3(0.3f, -0.5f, 0.8f));
    options.samples = 400000;
    const test::ChiSquareResult result = test::chi_square_sphere(
        [&](const Vec2& u, const Vec2& v, Vec3* direction) {
          *direction = m.sample(v.x, u);
          return true;
        },
        [&](const Vec3& d) { return m.pdf(d); }, options);
    EXPECT_TRUE(result.passed) << i << ": " << result.text;
    EXPECT_NEAR(result.mass, 1.0, 5e-3) << i;
  }
}

// The SIMD exponential is not that of the library.
TEST(DirectionMixture, DensityOfSamplesHasItsDigits) {
  Random random(4);
  for (int i = 0; i < 4; ++i) {
    const DirectionMixture m = i < 3 ? make_mixture(uint64_t(i) + 10, kConcentrations[i]) : make_mixed();
    for (int k = 0; k < 5000; ++k) {
      const float choice = random.get();
      const Vec3 d = m.sample(choice, random.get2());
      ASSERT_NEAR(glm::length(d), 1.0f, 1e-5f);
      const double truth = true_pdf(m, d);
      // A direction of floats is 1e-7 from the true one, which a sharp lobe feels.
      ASSERT_NEAR(m.pdf(d) / truth, 1.0, i == 2 || i == 3 ? 1e-3 : 2e-5) << i;
      const guide::LobeValues parts = m.parts(d);
      if (i < 3) {
        ASSERT_EQ(guide::get(parts, 0), 0.0f) << "a lobe without weight";
      }
      ASSERT_EQ(guide::sum_of(parts), m.pdf(d));
    }
  }
}

// Random numbers at the ends of their range choose lobes with a weight and give unit vectors.
TEST(DirectionMixture, SamplesAtTheEndsOfTheRandomNumbers) {
  constexpr float kEnd = 0.99999994f;
  for (const float concentration : kConcentrations) {
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0)}) {
      const DirectionMixture lobe = make_lobe(axis, concentration);
      for (const float choice : {0.0f, 0.5f, kEnd}) {
        for (const float u : {0.0f, kEnd}) {
          const Vec3 d = lobe.sample(choice, Vec2(u, kEnd));
          EXPECT_NEAR(glm::length(d), 1.0f, 1e-4f);
          EXPECT_GT(lobe.pdf(d), 0.0f);
          EXPECT_TRUE(is_finite(lobe.pdf(d)));
          EXPECT_TRUE(u > 0.0f || glm::dot(d, axis) > 0.9999f);
        }
      }
      EXPECT_GT(lobe.pdf(-axis), 0.0f) << "densities do not vanish";
    }
  }
}

}  // namespace
}  // namespace gradus::direction_mixture_test
