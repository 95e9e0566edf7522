// Closures with a guide: samples follow the density, and values do not change.
#include <cmath>

#include <gtest/gtest.h>

#include "bsdf/closures.h"
#include "bsdf/lobe_cases.h"
#include "guide/guiding_field.h"
#include "support/chi_square.h"

namespace gradus::test::guided_test {
namespace {

constexpr auto kDiffuse = bsdf::ScatterClass::Diffuse;

// Returns places of light above the surface, at its horizon, and below it.
guide::LitPlaces make_places() {
  std::vector<guide::Observation> observations;
  Random random(2);
  for (int i = 0; i < 600; ++i) {
    const Vec3 towards = tilted_direction(i % 3 == 0 ? 0.7f : i % 3 == 1 ? 0.05f : -0.6f, 2.0f * float(i % 3));
    const Vec3 blur(random.get() - 0.5f, random.get() - 0.5f, random.get() - 0.5f);
    observations.push_back({glm::normalize(towards + 0.3f * blur), 1.0f, 1.0f});
  }
  return guide::LitPlaces(Vec3(0.0f), observations);
}

// `guided` is the probability that the path is guided.
bsdf::Closures make_closures(const std::vector<bsdf::Lobe>& lobes, const Vec3& wo, float guided) {
  bsdf::Closures closures;
  for (bsdf::Lobe lobe : lobes) {
    lobe.normal = kTestNormal;
    lobe.tangent = Vec3(0, 1, 0);
    *closures.add() = lobe;
  }
  closures.finish(wo, kTestNormal, 0.1f);
  if (guided > 0.0f) closures.guide_by({make_places(), 0.5f}, Vec3(0.05f, -0.02f, 0.1f), guided);
  return closures;
}

bsdf::Lobe with_pass(bsdf::Lobe lobe, bsdf::LightPass pass) {
  lobe.pass = pass;
  return lobe;
}

struct Mix {
  const char* name;
  std::vector<bsdf::Lobe> lobes;
};

std::vector<Mix> mixes() {
  const bsdf::Lobe lambert = make_lobe(bsdf::LobeType::Diffuse), rough = make_lobe(bsdf::LobeType::Diffuse, 0.8f);
  const bsdf::Lobe glossy =
      with_pass(make_lobe(bsdf::LobeType::GgxReflection, 0.3f), bsdf::LightPass::Glossy);  // of class Diffuse
  bsdf::Lobe leaf = with_pass(make_lobe(bsdf::LobeType::Translucent), bsdf::LightPass::Transmission);
  leaf.weight = Rgb(0.4f);
  return {{"Lambert", {lambert}}, {"OrenNayar", {rough}}, {"Mix", {lambert, glossy, leaf}}};
}

const Vec3 kView = tilted_direction(0.6f, 1.0f);

TEST(GuidedClosures, SamplesFollowTheDensity) {
  for (const Mix& mix : mixes()) {
    const bsdf::Closures closures = make_closures(mix.lobes, kView, 1.0f);
    ChiSquareOptions options;
    options.axis = kTestNormal;
    options.samples = 500000;
    const auto sample = [&](const Vec2& u, const Vec2& v, Vec3* direction) {
      bsdf::BsdfSample s;
      const bool ok = closures.sample(kDiffuse, kView, v.x, u, &s);
      *direction = s.wi;
      return ok;
    };
    const ChiSquareResult result = chi_square_sphere(
        sample, [&](const Vec3& wi) { return closures.evaluate(kDiffuse, kView, wi).pdf; }, options);
    EXPECT_TRUE(result.passed) << mix.name << ": " << result.text;
    // The glossy lobe loses directions below the surface; guided directions are never lost.
    EXPECT_NEAR(result.mass, 1.0, mix.lobes.size() == 1 ? 5e-3 : 0.05) << mix.name;
    // The density without the guide is not that of the samples.
    const bsdf::Closures plain = make_closures(mix.lobes, kView, 0.0f);
    EXPECT_FALSE(chi_square_sphere(
                     sample, [&](const Vec3& wi) { return plain.evaluate(kDiffuse, kView, wi).pdf; }, options)
                     .passed);
  }
}

TEST(GuidedClosures, SampleAgreesWithEvaluate) {
  Random random(6);
  for (const Mix& mix : mixes()) {
    int above = 0, below = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3 wo = tilted_direction(std::max(1e-2f, random.get()), 6.0f * random.get());
      const bsdf::Closures guided = make_closures(mix.lobes, wo, i % 50 != 0 ? 1.0f : 0.0f);
      const bsdf::Closures plain = make_closures(mix.lobes, wo, 0.0f);
      bsdf::BsdfSample s;
      const float u = random.get();
      if (!guided.sample(kDiffuse, wo, u, random.get2(), &s)) continue;
      ++(s.transmitted ? below : above);
      ASSERT_EQ(s.transmitted, glm::dot(s.wi, kTestNormal) < 0.0f);
      const bsdf::BsdfEval all = guided.evaluate(kDiffuse, wo, s.wi), without = plain.evaluate(kDiffuse, wo, s.wi);
      ASSERT_NEAR(all.pdf, s.pdf, 1e-4f * s.pdf) << mix.name;
      ASSERT_NEAR(s.unguided_pdf, without.pdf, 1e-4f * without.pdf) << mix.name;
      const float ratio = guided.guided_ratio(kDiffuse, wo, s.wi, {});
      ASSERT_NEAR(ratio, without.pdf > 0.0f ? all.pdf / without.pdf : 1.0f, 1e-4f * ratio) << mix.name;
      ASSERT_LE(max_component(glm::abs(s.value - without.value)), 1e-4f * max_component(without.value)) << mix.name;
      const bsdf::KindEval kinds = guided.evaluate(kDiffuse, wo, s.wi, s.diffuse);
      const bsdf::KindEval others = guided.evaluate(kDiffuse, wo, s.wi, !s.diffuse);
      ASSERT_NEAR(kinds.kind.pdf, s.kind.pdf, 1e-4f * s.pdf) << mix.name;
      const float of_kind = plain.evaluate(kDiffuse, wo, s.wi, s.diffuse).kind.pdf;
      ASSERT_NEAR(s.unguided_kind_pdf, of_kind, 1e-4f * of_kind) << mix.name;
      const float kind_ratio = guided.guided_ratio(kDiffuse, wo, s.wi, s.diffuse);
      ASSERT_NEAR(kind_ratio, of_kind > 0.0f ? kinds.kind.pdf / of_kind : 1.0f, 1e-4f * kind_ratio) << mix.name;
      ASSERT_NEAR(kinds.kind.pdf + others.kind.pdf, all.pdf, 1e-4f * all.pdf) << mix.name;
      ASSERT_EQ(kinds.all.pdf, all.pdf) << mix.name;
      ASSERT_GT(s.kind.pdf, 0.0f);
    }
    EXPECT_GT(above, 2000) << mix.name;
    EXPECT_GT(below, 200) << mix.name << ": the guide also points below the surface";
  }
}

// Every value is that without the guide, as are the probabilities of the classes.
TEST(GuidedClosures, ValuesDoNotDependOnTheGuide) {
  Random random(8);
  for (const Mix& mix : mixes()) {
    const bsdf::Closures guided = make_closures(mix.lobes, kView, 1.0f), plain = make_closures(mix.lobes, kView, 0.0f);
    bool differs = false;
    for (int i = 0; i < 500; ++i) {
      const Vec3 wi = tilted_direction(2.0f * random.get() - 1.0f, 6.2f * random.get());
      const bool below = glm::dot(wi, kTestNormal) < 0.0f;
      EXPECT_EQ(guided.evaluate(kDiffuse, kView, wi).value, plain.evaluate(kDiffuse, kView, wi).value);
      EXPECT_EQ(guided.evaluate_by_pass(kDiffuse, kView, wi, below),
                plain.evaluate_by_pass(kDiffuse, kView, wi, below));
      differs = differs || guided.evaluate(kDiffuse, kView, wi).pdf != plain.evaluate(kDiffuse, kView, wi).pdf;
    }
    EXPECT_TRUE(differs) << mix.name;
    EXPECT_EQ(guided.class_probability(kDiffuse), plain.class_probability(kDiffuse));
    EXPECT_EQ(guided.ignores_wo(), plain.ignores_wo());
    EXPECT_EQ(guided.albedo(kView), plain.albedo(kView));
  }
}

// Filter Glossy blurs by this density, so that it is part of the picture.
TEST(GuidedClosures, DirectionPdfDoesNotDependOnTheGuide) {
  Random random(10);
  for (const Mix& mix : mixes()) {
    const bsdf::Closures guided = make_closures(mix.lobes, kView, 1.0f), plain = make_closures(mix.lobes, kView, 0.0f);
    for (int i = 0; i < 200; ++i) {
      const Vec3 wi = tilted_direction(2.0f * random.get() - 1.0f, 6.2f * random.get());
      EXPECT_NEAR(guided.unguided_pdf(kView, wi), plain.unguided_pdf(kView, wi), 1e-5f) << mix.name;
    }
    EXPECT_GT(guided.unguided_pdf(kView, kTestNormal), 0.1f);
  }
}

// A path that is guided with probability p has p times the density with the guide, and the rest of that without.
TEST(GuidedClosures, DensityIsMixedByTheProbability) {
  Random random(12);
  for (const Mix& mix : mixes()) {
    const bsdf::Closures plain = make_closures(mix.lobes, kView, 0.0f), guided = make_closures(mix.lobes, kView, 1.0f),
                         maybe = make_closures(mix.lobes, kView, 0.3f);
    for (int i = 0; i < 200; ++i) {
      const Vec3 wi = tilted_direction(2.0f * random.get() - 1.0f, 6.2f * random.get());
      const float a = plain.evaluate(kDiffuse, kView, wi).pdf, b = guided.evaluate(kDiffuse, kView, wi).pdf;
      EXPECT_NEAR(maybe.evaluate(kDiffuse, kView, wi).pdf, 0.7f * a + 0.3f * b, 1e-5f + 1e-4f * b) << mix.name;
    }
  }
}

// The share of guided directions is that of the diffuse lobes alone.
TEST(GuidedClosures, OnlyDiffuseLobesAreGuided) {
  const std::vector<bsdf::Lobe> glossy{make_lobe(bsdf::LobeType::GgxReflection, 0.3f)};
  const bsdf::Closures guided = make_closures(glossy, kView, 1.0f), plain = make_closures(glossy, kView, 0.0f);
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    const float u = random.get();
    const Vec2 v = random.get2();
    bsdf::BsdfSample a, b;
    ASSERT_EQ(guided.sample(kDiffuse, kView, u, v, &a), plain.sample(kDiffuse, kView, u, v, &b));
    ASSERT_EQ(a.wi, b.wi);
    ASSERT_EQ(a.pdf, b.pdf);
  }
}

// finish() for another view forgets the guide, which belongs to one side of the surface.
TEST(GuidedClosures, FinishEndsTheGuide) {
  bsdf::Closures closures = make_closures(mixes()[0].lobes, kView, 1.0f);
  const Vec3 wi = tilted_direction(0.7f, 0.0f);
  const float guided = closures.evaluate(kDiffuse, kView, wi).pdf;
  closures.finish(kView, kTestNormal, 0.1f);
  EXPECT_NEAR(closures.evaluate(kDiffuse, kView, wi).pdf, glm::dot(wi, kTestNormal) * kInvPi, 1e-5f);
  EXPECT_GT(guided, 1.2f * closures.evaluate(kDiffuse, kView, wi).pdf);
}

}  // namespace
}  // namespace gradus::test::guided_test
