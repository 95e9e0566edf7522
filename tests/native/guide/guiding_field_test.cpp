// The field: which cells are guided, and towards what.
#include "guide/guiding_field.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "support/chi_square.h"

namespace gradus::guiding_field_test {
namespace {

using guide::GuidingField;
using guide::TrainingSample;
using test::Random;

const Vec3 kUp(0, 0, 1);

// Radiance that a ray finds, with the distance.
using Scene = std::function<float(const Vec3& origin, const Vec3& direction, float* distance)>;

// A ceiling at height 1 that is bright in a square.
float spot(const Vec3& origin, const Vec3& direction, float* distance) {
  *distance = (1.0f - origin.z) / direction.z;
  const Vec3 at = origin + *distance * direction;
  return std::fabs(at.x - 0.5f) < 0.1f && std::fabs(at.y) < 0.1f ? 10.0f : 0.01f;
}

float uniform(const Vec3& /*origin*/, const Vec3& /*direction*/, float* distance) {
  *distance = kInfinity;
  return 1.0f;
}

// Returns samples of a square with cosine-weighted directions. Its corner is `corner`, and its edges are a and b, with
// the normal along a × b.
std::vector<TrainingSample> sample_square(const Scene& scene, const Vec3& corner, const Vec3& a, const Vec3& b,
                                          int count, float unit = 1.0f) {
  Random random(11);
  const Vec3 normal = glm::normalize(glm::cross(a, b)), x = glm::normalize(a), y = glm::cross(normal, x);
  std::vector<TrainingSample> samples;
  for (int i = 0; i < count; ++i) {
    const Vec2 p = random.get2(), u = random.get2();
    const float r = std::sqrt(u.x), cosine = std::sqrt(1.0f - u.x);
    const Vec3 d = r * std::cos(6.2831853f * u.y) * x + r * std::sin(6.2831853f * u.y) * y + cosine * normal;
    TrainingSample s;
    s.position = corner + p.x * a + p.y * b;
    s.normal = normal;
    s.direction = d;
    s.radiance = scene(s.position, d, &s.distance);
    s.position *= unit;
    s.distance *= unit;
    s.pdf = cosine * 0.31830989f;
    samples.push_back(s);
  }
  return samples;
}
std::vector<TrainingSample> sample_floor(const Scene& scene, int count, float unit = 1.0f) {
  return sample_square(scene, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), count, unit);
}

guide::DirectionMixture seen_from(const GuidingField& field, const Vec3& position, const Vec3& normal) {
  guide::DirectionMixture m;
  field.at(position, normal)->places.see_from(position, normal, &m);
  return m;
}

TEST(GuidingField, PointsFromTheFloorToASpotOfLight) {
  for (const float unit : {1e-3f, 1.0f, 1e6f}) {
    const GuidingField field(sample_floor(spot, 40000, unit));
    EXPECT_GT(field.guided_share(), 0.9f);
    for (const Vec3& from : {Vec3(0.0f), Vec3(0.7f, 0.6f, 0), Vec3(-0.6f, 0.2f, 0)}) {
      ASSERT_NE(field.at(unit * from, kUp), nullptr);
      const Vec3 to = glm::normalize(Vec3(0.5f, 0, 1) - from);
      const float density = seen_from(field, unit * from, kUp).pdf(to);
      EXPECT_GT(density, 5.0f * to.z * kInvPi) << unit << ' ' << from.x;
    }
  }
}

// Half of the ceiling has steady light, and the other half the same light in one of a hundred paths.
TEST(GuidingField, PrefersRareLightOfTheSameMean) {
  Random random(7);
  const GuidingField field(sample_floor(
      [&random](const Vec3& origin, const Vec3& direction, float* distance) {
        const float x = origin.x + (*distance = (1.0f - origin.z) / direction.z) * direction.x;
        if (x < 0.0f) return 1.0f;
        return random.get() < 0.01f ? 100.0f : 0.0f;
      },
      40000));
  ASSERT_NE(field.at(Vec3(0.0f), kUp), nullptr);
  const guide::DirectionMixture m = seen_from(field, Vec3(0.0f), kUp);
  double steady = 0.0, rare = 0.0;
  for (int i = 0; i < 10000; ++i) (m.sample(random.get(), random.get2()).x < 0.0f ? steady : rare) += 1.0;
  // Lobes that are fitted to the mean alone would take both equally often.
  EXPECT_GT(rare, 1.5 * steady);
}

// The density of a path is a mean of those with and without a guide, however its vertices differ.
TEST(GuidedProbability, MixesTheDensitiesOfWholePaths) {
  Random random(5);
  for (int path = 0; path < 1000; ++path) {
    float ratio = 1.0f;   // density of the path over that without a guide
    double guided = 1.0;  // the same if all vertices were guided
    for (int vertex = 0; vertex < 8; ++vertex) {
      const float here = std::exp(6.0f * (random.get() - 0.7f));
      const float probability = guide::guided_probability(ratio);
      ASSERT_GE(probability, 0.0f);
      ASSERT_LT(probability, 1.0f);
      ratio *= 1.0f - probability + probability * here;
      guided *= here;
      const double expected = guide::kUnguidedPaths + (1.0 - guide::kUnguidedPaths) * guided;
      ASSERT_NEAR(ratio, expected, 1e-4 * expected);
    }
  }
  EXPECT_EQ(guide::guided_probability(1.0f), 1.0f - guide::kUnguidedPaths);
}

TEST(GuidingField, UniformLightIsNotGuided) {
  const GuidingField field(sample_floor(uniform, 20000));
  EXPECT_EQ(field.guided_share(), 0.0f);
  for (const Vec3& from : {Vec3(0.0f), Vec3(0.7f, 0.6f, 0)}) EXPECT_EQ(field.at(from, kUp), nullptr);
}

// A dark scene gives no reason to guide.
TEST(GuidingField, DarknessIsNotGuided) {
  const GuidingField field(sample_floor(
      [](const Vec3&, const Vec3&, float* distance) {
        *distance = 1.0f;
        return 0.0f;
      },
      5000));
  EXPECT_EQ(field.at(Vec3(0.0f), kUp), nullptr);
}

// A spot lights the floor, and uniform light a wall that stands on it.
TEST(GuidingField, FloorAndWallAreSeparate) {
  std::vector<TrainingSample> samples = sample_floor(spot, 20000);
  for (const TrainingSample& s : sample_square(uniform, Vec3(-1, 0, 0), Vec3(0, 0, 0.2f), Vec3(2, 0, 0), 20000))
    samples.push_back(s);
  const GuidingField field(samples);
  const Vec3 wall = glm::normalize(glm::cross(Vec3(0, 0, 0.2f), Vec3(2, 0, 0)));
  int guided_floor = 0, guided_wall = 0;
  for (int i = 0; i < 20; ++i) {
    const Vec3 at(-0.95f + 0.1f * float(i), 0.0f, 0.0f);
    guided_floor += field.at(at, kUp) != nullptr ? 1 : 0;
    guided_wall += field.at(at + Vec3(0, 0, 0.05f), wall) != nullptr ? 1 : 0;
  }
  EXPECT_GE(guided_floor, 16);
  EXPECT_LE(guided_wall, 4);
}

// Both sides of a sheet, too.
TEST(GuidingField, SidesOfASheetAreSeparate) {
  std::vector<TrainingSample> samples = sample_floor(spot, 20000);
  for (const TrainingSample& s : sample_square(uniform, Vec3(-1, -1, 0), Vec3(0, 2, 0), Vec3(2, 0, 0), 20000))
    samples.push_back(s);
  const GuidingField field(samples);
  EXPECT_NE(field.at(Vec3(0.2f, 0.1f, 0), kUp), nullptr);
  EXPECT_EQ(field.at(Vec3(0.2f, 0.1f, 0), -kUp), nullptr);
}

TEST(GuidingField, FewSamplesGiveNoGuide) {
  for (const int count : {0, 1, 63}) {
    const GuidingField field(sample_floor(spot, count));
    EXPECT_EQ(field.at(Vec3(0.0f), kUp), nullptr) << count;
    EXPECT_EQ(field.guided_share(), 0.0f);
  }
}

// All samples at one point cannot be divided.
TEST(GuidingField, SamplesOfOnePointAreOneCell) {
  std::vector<TrainingSample> samples = sample_floor(spot, 10000);
  for (TrainingSample& s : samples) {
    s.position = Vec3(0.0f);
    s.radiance = spot(s.position, s.direction, &s.distance);
  }
  const GuidingField field(samples);
  ASSERT_NE(field.at(Vec3(0.0f), kUp), nullptr);
  EXPECT_EQ(field.at(Vec3(0.0f), kUp), field.at(Vec3(5.0f), kUp));
  EXPECT_GT(seen_from(field, Vec3(0.0f), kUp).pdf(glm::normalize(Vec3(0.5f, 0, 1))), 2.0f);
}

// Radiance that overflows must not reach the densities.
TEST(GuidingField, InfiniteLightLeavesDensitiesFinite) {
  for (const size_t outlier : {size_t{100}, size_t{101}}) {
    std::vector<TrainingSample> samples = sample_floor(spot, 4000);
    samples[outlier].radiance = 3e38f;
    samples[outlier].pdf = 1e-3f;
    samples[outlier].direction = kUp;
    const GuidingField field(samples);
    if (field.at(Vec3(0.0f), kUp) == nullptr) continue;
    const float density = seen_from(field, Vec3(0.0f), kUp).pdf(glm::normalize(Vec3(0.5f, 0, 1)));
    EXPECT_TRUE(is_finite(density));
    EXPECT_GT(density, 0.0f);
  }
}

TEST(GuidingField, GuidesNowhereOnceItIsStopped) {
  const std::atomic<bool> stop{true};
  const GuidingField field(sample_floor(spot, 40000), &stop);
  EXPECT_EQ(field.guided_share(), 0.0f);
  EXPECT_EQ(field.at(Vec3(0.0f), kUp), nullptr);
}

TEST(GuidingField, IsDeterministic) {
  const std::vector<TrainingSample> samples = sample_floor(spot, 20000);
  const GuidingField first(samples), second(samples);
  EXPECT_EQ(first.guided_share(), second.guided_share());
  for (float x = -0.9f; x < 1.0f; x += 0.3f) {
    const Vec3 from(x, -0.5f * x, 0);
    ASSERT_NE(first.at(from, kUp), nullptr);
    EXPECT_EQ(seen_from(first, from, kUp).pdf(kUp), seen_from(second, from, kUp).pdf(kUp));
  }
}

}  // namespace
}  // namespace gradus::guiding_field_test
