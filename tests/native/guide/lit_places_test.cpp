// The fit of lit places: parallax, lobes below surfaces, and observations that a fit must survive.
#include "guide/lit_places.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/chi_square.h"

namespace gradus::lit_places_test {
namespace {

using guide::DirectionMixture;
using guide::LitPlaces;
using guide::Observation;
using test::Random;

const Vec3 kUp(0, 0, 1);

Vec3 random_direction(Random* random) {
  const float z = 2.0f * random->get() - 1.0f, r = std::sqrt(1.0f - z * z), phi = 6.2831853f * random->get();
  return Vec3(r * std::cos(phi), r * std::sin(phi), z);
}

DirectionMixture seen_from(const LitPlaces& places, const Vec3& position, const Vec3& normal = kUp) {
  DirectionMixture mixture;
  places.see_from(position, normal, &mixture);
  return mixture;
}

// Returns the share of samples within an angle of a direction.
double share_towards(const DirectionMixture& mixture, const Vec3& direction, float angle) {
  Random random(3);
  constexpr int kSamples = 4000;
  int count = 0;
  for (int i = 0; i < kSamples; ++i) {
    const float choice = random.get();
    count += glm::dot(mixture.sample(choice, random.get2()), direction) > std::cos(angle) ? 1 : 0;
  }
  return double(count) / kSamples;
}

void expect_valid(const DirectionMixture& m) {
  float sum = 0.0f;
  for (size_t i = 0; i < guide::kLobes; ++i) {
    EXPECT_NEAR(guide::get(m.x, i) * guide::get(m.x, i) + guide::get(m.y, i) * guide::get(m.y, i) +
                    guide::get(m.z, i) * guide::get(m.z, i),
                1.0f, 1e-4f);
    EXPECT_GE(guide::get(m.concentration, i), DirectionMixture::kMinConcentration);
    EXPECT_LE(guide::get(m.concentration, i), DirectionMixture::kMaxConcentration);
    EXPECT_GE(guide::get(m.weight, i), 0.0f);
    sum += guide::get(m.weight, i);
  }
  EXPECT_NEAR(sum, 1.0f, 1e-4f);
  for (const Vec3& d : {kUp, -kUp, Vec3(1, 0, 0), Vec3(0, -1, 0)}) {
    EXPECT_GT(m.pdf(d), 0.0f);
    EXPECT_TRUE(is_finite(m.pdf(d)));
  }
}

// Returns observations around the origin of light from a ball, over a floor that sends little light everywhere.
std::vector<Observation> observe_ball(const Vec3& centre, float radius, int count) {
  Random random(5);
  std::vector<Observation> observations;
  for (int i = 0; i < count; ++i) {
    const Vec3 to = centre + radius * random_direction(&random);
    observations.push_back({glm::normalize(to), glm::length(to), 0.5f + random.get()});
    observations.push_back({random_direction(&random), 2.0f, 0.05f});
  }
  return observations;
}

TEST(LitPlaces, LobesPointToThePlaceFromEverywhere) {
  const Vec3 place(1.0f, 0.0f, 1.0f);
  const LitPlaces places(Vec3(0.0f), observe_ball(place, 0.1f, 500));
  for (const Vec3& from : {Vec3(0.0f), Vec3(-0.5f, 0.5f, 0.0f), Vec3(0.5f, -0.7f, 0.2f), Vec3(-1.0f, 0.0f, 0.0f)}) {
    const DirectionMixture m = seen_from(places, from);
    expect_valid(m);
    const Vec3 to = place - from;
    // The ball sends about 90 % of the light.
    EXPECT_GT(share_towards(m, glm::normalize(to), std::atan(0.3f / glm::length(to))), 0.6) << from.x;
    const double elsewhere = from == Vec3(0.0f) ? 0.0 : share_towards(m, glm::normalize(place), 0.1f);
    EXPECT_LT(elsewhere, 0.2) << from.x << ": in the direction that the centre sees";
  }
}

// From nearer the place has a larger angle: its lobes are wider.
TEST(LitPlaces, LobesWidenTowardsThePlace) {
  const Vec3 place(0.0f, 0.0f, 2.0f);
  const LitPlaces places(Vec3(0.0f), observe_ball(place, 0.3f, 500));
  const float far = seen_from(places, Vec3(0.0f)).pdf(kUp), near = seen_from(places, Vec3(0, 0, 1)).pdf(kUp);
  EXPECT_NEAR(far / near, 4.0f, 1.5f);
}

TEST(LitPlaces, DistantLightHasNoParallax) {
  const Vec3 direction = glm::normalize(Vec3(1.0f, 0.5f, 1.0f));
  std::vector<Observation> observations = observe_ball(1e3f * direction, 100.0f, 500);
  const LitPlaces places(Vec3(0.0f), observations);
  for (const Vec3& from : {Vec3(0.0f), Vec3(0.5f, -0.5f, 0.0f), Vec3(-0.5f, 0.5f, 0.3f)}) {
    expect_valid(seen_from(places, from));
    EXPECT_GT(share_towards(seen_from(places, from), direction, 0.2f), 0.7);
  }
}

TEST(LitPlaces, LobesBelowTheSurfaceHaveLittleWeight) {
  std::vector<Observation> observations = observe_ball(Vec3(0, 0, 1), 0.1f, 300);
  for (const Observation& o : observe_ball(Vec3(0, 0, -1), 0.1f, 300)) observations.push_back(o);
  const LitPlaces places(Vec3(0.0f), observations);
  EXPECT_GT(share_towards(seen_from(places, Vec3(0.0f), kUp), kUp, 1.57f), 0.85);
  EXPECT_GT(share_towards(seen_from(places, Vec3(0.0f), -kUp), -kUp, 1.57f), 0.85);
  // Both places are at the horizon of a wall.
  EXPECT_NEAR(share_towards(seen_from(places, Vec3(0.0f), Vec3(1, 0, 0)), kUp, 1.57f), 0.5, 0.1);
}

TEST(LitPlaces, WithoutLightNoDirectionIsPreferred) {
  const Observation dark{kUp, 1.0f, 0.0f};
  for (const std::vector<Observation>& none : {std::vector<Observation>{}, std::vector<Observation>(100, dark)}) {
    const DirectionMixture m = seen_from(LitPlaces(Vec3(3.0f), none), Vec3(2.0f, 3.0f, 2.5f));
    expect_valid(m);
    EXPECT_LT(m.pdf(kUp) / m.pdf(-kUp), 2.0f);
    EXPECT_GT(m.pdf(kUp) / m.pdf(-kUp), 0.5f);
  }
}

// One bright path is no place.
TEST(LitPlaces, AnOutlierDoesNotTakeAllLobes) {
  const Vec3 place(1.0f, 0.0f, 1.0f);
  std::vector<Observation> observations = observe_ball(place, 0.1f, 500);
  observations.push_back({glm::normalize(Vec3(-1, 0, 1)), 1.0f, 1e6f});
  const DirectionMixture m = seen_from(LitPlaces(Vec3(0.0f), observations), Vec3(0.0f));
  expect_valid(m);
  EXPECT_GT(share_towards(m, glm::normalize(place), 0.3f), 0.3);
}

// One observation makes no sharp lobe.
TEST(LitPlaces, FewObservationsMakeWideLobes) {
  const Observation one{kUp, 1.0f, 1.0f};
  const DirectionMixture m = seen_from(LitPlaces(Vec3(0.0f), {&one, 1}), Vec3(0.0f));
  expect_valid(m);
  EXPECT_LT(m.pdf(kUp), 2.0f);
  EXPECT_GT(m.pdf(kUp), m.pdf(-kUp));
}

// At a place itself, its lobe still has a unit axis, so that samples follow the density.
TEST(LitPlaces, ThePlaceItselfSeesAValidMixture) {
  const Observation one{kUp, 1.0f, 1.0f};
  const LitPlaces places(Vec3(0.0f), std::vector<Observation>(100, one));
  expect_valid(seen_from(places, kUp));
  expect_valid(seen_from(LitPlaces(Vec3(0.0f), {}), kUp));
  EXPECT_GT(seen_from(places, kUp, Vec3(1, 0, 0)).pdf(Vec3(1, 0, 0)), 0.0f);
}

// The shape of the mixture does not depend on units, nor on the strength of the light.
TEST(LitPlaces, UnitsDoNotMatter) {
  const Vec3 place(1.0f, 0.0f, 1.0f), from(-0.3f, 0.2f, 0.1f), to = glm::normalize(place - from);
  const float expected = seen_from(LitPlaces(Vec3(0.0f), observe_ball(place, 0.1f, 200)), from).pdf(to);
  for (const float unit : {1e-3f, 1e6f}) {
    for (const float strength : {1e-20f, 1e20f}) {
      std::vector<Observation> observations = observe_ball(place, 0.1f, 200);
      for (Observation& o : observations) o.distance *= unit, o.weight *= strength;
      const DirectionMixture m = seen_from(LitPlaces(Vec3(0.0f), observations), unit * from);
      expect_valid(m);
      EXPECT_NEAR(m.pdf(to) / expected, 1.0f, 1e-2f) << unit << ' ' << strength;
    }
  }
}

}  // namespace
}  // namespace gradus::lit_places_test
