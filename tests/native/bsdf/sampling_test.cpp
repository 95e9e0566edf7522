// A3: samples follow the density; A4: densities and values agree with each other.
#include <cmath>

#include <gtest/gtest.h>

#include "bsdf/closures.h"
#include "bsdf/lobe_cases.h"
#include "support/chi_square.h"
#include "support/statistics.h"

namespace gradus::test::sampling_test {
namespace {

constexpr float kCosines[] = {1.0f, 0.8f, 0.5f, 0.2f, 0.05f};

constexpr size_t kSamples = 1000000;

void check_class(const LobeCase& test, const bsdf::Closures& closures, const Vec3& wo, bsdf::ScatterClass c) {
  if (!closures.has_smooth(c)) {
    return;
  }
  ChiSquareOptions options;
  options.axis = kTestNormal;
  options.samples = kSamples;
  const ChiSquareResult result = chi_square_sphere(
      [&](const Vec2& u, const Vec2& v, Vec3* direction) {
        bsdf::BsdfSample s;
        const bool ok = closures.sample(c, wo, v.x, u, &s);
        *direction = s.wi;
        return ok;
      },
      [&](const Vec3& wi) { return closures.evaluate(c, wo, wi).pdf; }, options);
  EXPECT_TRUE(result.passed) << test.name << " class " << static_cast<int>(c) << " cosine " << glm::dot(wo, kTestNormal)
                             << ": " << result.text;
}

// Checks each lobe for five views in the full run, else for two that change from lobe to lobe.
void check(const std::vector<LobeCase>& cases, float threshold) {
  for (size_t n = 0; n < cases.size(); ++n) {
    for (size_t k = 0; k < (test::full_run() ? 5 : 2); ++k) {
      const size_t view = (n + 2 * k) % 5;
      const Vec3 wo = tilted_direction(kCosines[view], 2.0f * static_cast<float>(view));
      const bsdf::Closures closures = finished(cases[n].lobe, wo, threshold);
      for (int c = 0; c < bsdf::kScatterClasses; c++) {
        check_class(cases[n], closures, wo, static_cast<bsdf::ScatterClass>(c));
      }
    }
  }
}

TEST(A3_ChiSquare, Diffuse) { check(diffuse_cases(), 0.1f); }

TEST(A3_ChiSquare, MicrofacetsRough) { check(microfacet_cases(0.7f), 0.1f); }

TEST(A3_ChiSquare, MicrofacetsGlossy) { check(microfacet_cases(0.4f), 0.5f); }

TEST(A3_ChiSquare, MixedLobesOfOneClass) {
  const Vec3 wo = tilted_direction(0.6f, 1.0f);
  bsdf::Closures closures;
  bsdf::Lobe diffuse = make_lobe(bsdf::LobeType::Diffuse);
  bsdf::Lobe glossy = make_lobe(bsdf::LobeType::GgxReflection, 0.2f);
  bsdf::Lobe glass = make_lobe(bsdf::LobeType::GgxGlass, 0.3f, bsdf::FresnelType::Dielectric, 1.4f);
  for (bsdf::Lobe* lobe : {&diffuse, &glossy, &glass}) {
    lobe->normal = kTestNormal;
    *closures.add() = *lobe;
  }
  closures.finish(wo, kTestNormal, 0.1f);
  check_class({"Mixed", diffuse, false}, closures, wo, bsdf::ScatterClass::Diffuse);
}

// Shows that the test can fail: it detects a density that is 3 % off in one half.
TEST(A3_ChiSquare, DetectsAWrongDensity) {
  const Vec3 wo = tilted_direction(0.6f, 1.0f);
  const bsdf::Closures closures = finished(make_lobe(bsdf::LobeType::Diffuse), wo);
  ChiSquareOptions options;
  options.axis = kTestNormal;
  options.samples = kSamples;
  options.rows = 20;
  options.columns = 40;
  const ChiSquareResult result = chi_square_sphere(
      [&](const Vec2& u, const Vec2& v, Vec3* direction) {
        bsdf::BsdfSample s;
        const bool ok = closures.sample(bsdf::ScatterClass::Diffuse, wo, v.x, u, &s);
        *direction = s.wi;
        return ok;
      },
      [&](const Vec3& wi) {
        return closures.evaluate(bsdf::ScatterClass::Diffuse, wo, wi).pdf * (wi.x > 0.0f ? 1.03 : 0.97);
      },
      options);
  EXPECT_FALSE(result.passed) << result.text;
}

TEST(A4_Densities, SampleAgreesWithEvaluate) {
  Random random(5);
  std::vector<LobeCase> cases = diffuse_cases();
  for (const float roughness : {0.05f, 0.2f, 0.5f, 1.0f}) {
    for (const LobeCase& test : microfacet_cases(roughness)) cases.push_back(test);
  }
  int compared = 0;
  for (const LobeCase& test : cases) {
    for (int i = 0; i < 2000; i++) {
      const Vec3 wo = tilted_direction(std::max(1e-3f, random.get()), random.get() * 6.0f);
      const bsdf::Closures closures = finished(test.lobe, wo);
      for (int c = 0; c < bsdf::kScatterClasses; c++) {
        const bsdf::ScatterClass k = static_cast<bsdf::ScatterClass>(c);
        bsdf::BsdfSample s;
        if (closures.sample(k, wo, random.get(), random.get2(), &s) && !s.dirac) {
          ++compared;
          const bsdf::BsdfEval eval = closures.evaluate(k, wo, s.wi);
          ASSERT_NEAR(eval.pdf, s.pdf, 1e-4f * s.pdf) << test.name;
          ASSERT_LE(max_component(glm::abs(eval.value - s.value)), 1e-4f * max_component(s.value)) << test.name;
          ASSERT_EQ(s.transmitted, glm::dot(s.wi, kTestNormal) < 0.0f);
        }
      }
    }
  }
  EXPECT_GE(compared, 100000);
}

// f(wo, wi) = f(wi, wo) for reflection. Energy compensation, the fitted sheen and toons are exempt: they depend on the
// view alone, or have no factor of the cosine.
TEST(A4_Densities, Reciprocity) {
  Random random(9);
  std::vector<LobeCase> cases = diffuse_cases();
  for (const float roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
    for (const LobeCase& test : microfacet_cases(roughness)) {
      cases.push_back(test);
    }
  }
  for (const LobeCase& test : cases) {
    const bool compensated = test.lobe.multiscatter && test.lobe.type != bsdf::LobeType::Diffuse;
    const bool fitted = test.lobe.type == bsdf::LobeType::Sheen && test.lobe.fresnel == bsdf::FresnelType::None;
    const bool toon = test.lobe.type == bsdf::LobeType::DiffuseToon || test.lobe.type == bsdf::LobeType::GlossyToon;
    if (compensated || fitted || toon || bsdf::sides_of(test.lobe.type) == bsdf::kTransmits) {
      continue;
    }
    for (int i = 0; i < 1000; i++) {
      const Vec3 a = tilted_direction(0.02f + 0.98f * random.get(), random.get() * 6.0f);
      const Vec3 b = tilted_direction(0.02f + 0.98f * random.get(), random.get() * 6.0f);
      Rgb forth(0.0f);
      Rgb back(0.0f);
      const bsdf::Closures from_a = finished(test.lobe, a);
      const bsdf::Closures from_b = finished(test.lobe, b);
      for (int c = 0; c < bsdf::kScatterClasses; c++) {
        forth += from_a.evaluate(static_cast<bsdf::ScatterClass>(c), a, b).value / glm::dot(b, kTestNormal);
        back += from_b.evaluate(static_cast<bsdf::ScatterClass>(c), b, a).value / glm::dot(a, kTestNormal);
      }
      ASSERT_LE(max_component(glm::abs(forth - back)), 1e-4f * std::max(max_component(forth), 1e-3f)) << test.name;
    }
  }
}

TEST(A4_Densities, ByPassSumsToValue) {
  const Vec3 wo = tilted_direction(0.6f, 1.0f);
  bsdf::Closures closures;
  bsdf::Lobe diffuse = make_lobe(bsdf::LobeType::Diffuse);
  bsdf::Lobe glass = make_lobe(bsdf::LobeType::GgxGlass, 0.3f, bsdf::FresnelType::Dielectric, 1.4f);
  diffuse.normal = glass.normal = kTestNormal;
  glass.pass = bsdf::LightPass::Transmission;
  *closures.add() = diffuse;
  *closures.add() = glass;
  closures.finish(wo, kTestNormal, 0.1f);
  const Vec3 above = tilted_direction(0.5f, 4.0f);
  const Vec3 below = tilted_direction(-0.7f, 4.1f);
  for (const Vec3& wi : {above, below}) {
    const auto parts = closures.evaluate_by_pass(bsdf::ScatterClass::Diffuse, wo, wi, wi.z < 0.0f);
    const Rgb whole = closures.evaluate(bsdf::ScatterClass::Diffuse, wo, wi).value;
    EXPECT_NEAR(parts[0].x + parts[1].x + parts[2].x, whole.x, 1e-6f);
  }
  EXPECT_GT(closures.evaluate_by_pass(bsdf::ScatterClass::Diffuse, wo, above, above.z < 0.0f)[1].x, 0.0f);
  EXPECT_GT(closures.evaluate_by_pass(bsdf::ScatterClass::Diffuse, wo, below, below.z < 0.0f)[2].x, 0.0f);
}

// Offset paths reuse the base path's evaluation of a vertex whose closures ignore wo.
TEST(ClosuresThatIgnoreWo, AreTheSameFromEverywhereOnOneSide) {
  std::vector<LobeCase> cases = diffuse_cases();
  for (const LobeCase& c : microfacet_cases(0.5f)) cases.push_back(c);
  const Vec3 views[] = {glm::normalize(Vec3(0.1f, 0.2f, 1.0f)), glm::normalize(Vec3(-1.0f, 0.3f, 0.2f))};
  const Vec3 lights[] = {glm::normalize(Vec3(0.4f, -0.5f, 0.7f)), glm::normalize(Vec3(0.9f, 0.1f, 0.1f)),
                         Vec3(0, 0, -1)};
  for (const LobeCase& c : cases) {
    bsdf::Closures seen[2];
    for (int i = 0; i < 2; ++i) {
      *seen[i].add() = make_lobe(bsdf::LobeType::Diffuse);
      bsdf::Lobe lobe = c.lobe;
      lobe.normal = glm::normalize(Vec3(0.2f, 0.0f, 1.0f));  // the normal of a bump map
      *seen[i].add() = lobe;
      seen[i].finish(views[i], Vec3(0, 0, 1), 0.1f, Vec3(0, 0, 1));
    }
    EXPECT_EQ(seen[0].ignores_wo(), c.name == "Lambert") << c.name;
    if (!seen[0].ignores_wo()) continue;
    EXPECT_EQ(seen[0].class_probability(bsdf::ScatterClass::Diffuse),
              seen[1].class_probability(bsdf::ScatterClass::Diffuse));
    for (const Vec3& wi : lights) {
      const bsdf::BsdfEval a = seen[0].evaluate(bsdf::ScatterClass::Diffuse, views[0], wi),
                           b = seen[1].evaluate(bsdf::ScatterClass::Diffuse, views[1], wi);
      EXPECT_EQ(a.value, b.value);
      EXPECT_EQ(a.pdf, b.pdf);
    }
  }
}

}  // namespace
}  // namespace gradus::test::sampling_test
