// A2: no closure adds energy, and lossless closures lose none.
#include <cmath>

#include <gtest/gtest.h>

#include "bsdf/closures.h"
#include "bsdf/lobe_cases.h"
#include "support/chi_square.h"

namespace gradus::test::furnace_test {
namespace {

// Returns the mean of value/(pdf·P(class)) under uniform light: the directional albedo.
Rgb measured_albedo(const bsdf::Closures& closures, const Vec3& wo, int samples, uint64_t seed) {
  Random random(seed);
  Rgb sum(0.0f);
  for (int i = 0; i < samples; i++) {
    float choice = random.get();
    const float u_lobe = random.get();
    // Samples are stratified: 16,384 independent samples would have too much noise for the bound of 1 %.
    const int side = static_cast<int>(std::sqrt(static_cast<double>(samples)));
    const Vec2 u((static_cast<float>(i % side) + random.get()) / static_cast<float>(side),
                 (static_cast<float>(i / side % side) + random.get()) / static_cast<float>(side));
    for (int c = 0; c < bsdf::kScatterClasses; c++) {
      const bsdf::ScatterClass k = static_cast<bsdf::ScatterClass>(c);
      const float p = closures.class_probability(k);
      if (choice < p) {
        bsdf::BsdfSample s;
        if (closures.sample(k, wo, u_lobe, u, &s)) {
          EXPECT_TRUE(is_finite(s.value) && s.pdf > 0.0f && is_finite(s.pdf));
          sum += s.value / (s.pdf * p);
        }
        break;
      }
      choice -= p;
    }
  }
  return sum / static_cast<float>(samples);
}

constexpr int kSamples = 16384;
constexpr float kCosines[] = {1.0f, 0.8f, 0.6f, 0.4f, 0.3f, 0.2f, 0.1f, 0.03f, 0.01f, 1e-3f};

void check(const LobeCase& test, float threshold) {
  for (int i = 0; i < 10; i++) {
    const Vec3 wo = tilted_direction(kCosines[i], static_cast<float>(i));
    const bsdf::Closures closures = finished(test.lobe, wo, threshold);
    const Rgb measured = measured_albedo(closures, wo, kSamples, 17 + static_cast<uint64_t>(i));
    EXPECT_LE(max_component(measured), test.bounded ? 1.01f : 1.6f) << test.name << " at cosine " << kCosines[i];
    if (test.lossless) {
      EXPECT_GE(mean_component(measured), 0.99f) << test.name << " at cosine " << kCosines[i];
    }
  }
}

TEST(A2_WhiteFurnace, Diffuse) {
  for (const LobeCase& test : diffuse_cases()) {
    check(test, 0.1f);
  }
}

TEST(A2_WhiteFurnace, Microfacets) {
  for (const float roughness : {0.0f, 1e-4f, 0.05f, 0.5f, 1.0f}) {
    for (const LobeCase& test : microfacet_cases(roughness)) {
      SCOPED_TRACE(roughness);
      check(test, 0.1f);
    }
  }
}

TEST(A2_WhiteFurnace, DiracIsLossless) {
  for (const bsdf::FresnelType fresnel : {bsdf::FresnelType::None, bsdf::FresnelType::Dielectric}) {
    for (const float ior : {1.0f, 1.5f, 0.6f, 3.0f}) {
      check({"DiracGlass", make_lobe(bsdf::LobeType::DiracGlass, 0.0f, fresnel, ior), true}, 0.1f);
    }
  }
  check({"Mirror", make_lobe(bsdf::LobeType::DiracReflection), true}, 0.1f);
}

// One lobe has the same albedo whether glass is sampled as one rough class or as two specular classes.
TEST(A2_WhiteFurnace, ClassesDoNotChangeEnergy) {
  const bsdf::Lobe glass = make_lobe(bsdf::LobeType::GgxGlass, 0.25f, bsdf::FresnelType::Dielectric, 1.5f);
  for (const float cosine : {1.0f, 0.5f, 0.1f}) {
    const Vec3 wo = tilted_direction(cosine, 1.0f);
    const float together = measured_albedo(finished(glass, wo, 0.1f), wo, kSamples, 5).x;
    const float separate = measured_albedo(finished(glass, wo, 0.5f), wo, kSamples, 6).x;
    EXPECT_NEAR(together, separate, 0.01f);
  }
}

// Compares tabulated albedos with sampled ones. Layering, colour passes and compensation use the tables.
TEST(A2_WhiteFurnace, TabulatedAlbedo) {
  std::vector<LobeCase> cases = diffuse_cases();
  for (const float roughness : {0.0f, 0.05f, 0.3f, 0.5f, 0.7f, 1.0f}) {
    for (const LobeCase& test : microfacet_cases(roughness)) {
      cases.push_back(test);
      cases.back().name += " roughness " + std::to_string(roughness);
    }
  }
  for (const LobeCase& test : cases) {
    if (!test.tabulated || !test.bounded) {
      continue;
    }
    for (const float cosine : {1.0f, 0.7f, 0.4f, 0.2f, 0.1f, 0.03f}) {
      const Vec3 wo = tilted_direction(cosine, 2.0f);
      const bsdf::Closures closures = finished(test.lobe, wo);
      const Rgb measured = measured_albedo(closures, wo, kSamples, 3);
      const Rgb table = closures.albedo(wo);
      EXPECT_LE(max_component(glm::abs(measured - table)), 0.010f)
          << test.name << " cosine " << cosine << " measured " << measured.x << " table " << table.x;
    }
  }
}

}  // namespace
}  // namespace gradus::test::furnace_test
