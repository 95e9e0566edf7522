// Surfaces with more closures than the maximum: none may be lost.
#include <cmath>

#include <gtest/gtest.h>

#include "bsdf/lobe.h"
#include "shading/program_builder.h"

namespace gradus::test::many_closures_test {
namespace {

const Vec3 kWo = glm::normalize(Vec3(0.5f, 0.2f, 1.0f));

// Returns an equal mix of `layers`.
int mixed(ProgramBuilder* b, const std::vector<int>& layers) {
  int mix = layers[0];
  for (size_t i = 1; i < layers.size(); i++)
    mix = b->add(GRADUS_OP_MIX_SHADER, {In(1.0f / static_cast<float>(i + 1)), In::from(mix), In::from(layers[i])});
  return mix;
}

// Returns sheen, coat, metal, glass, specular and diffuse; roughness differs from material to material.
int rich_principled(ProgramBuilder* b, float roughness) {
  std::vector<In> in(21, In(0.0f));
  in[0] = In(Vec3(0.8f, 0.4f, 0.2f));
  in[1] = In(0.4f);
  in[2] = In(roughness);
  in[3] = In(1.5f);
  in[5] = In(0.5f);
  in[6] = In(1.0f);
  in[9] = In(0.3f);
  in[10] = In(0.5f);
  in[11] = In(0.3f);
  in[12] = In(1.5f);
  in[13] = In(1.0f);
  in[14] = In(0.5f);
  in[15] = In(0.5f);
  in[16] = In(1.0f);
  return b->add(GRADUS_OP_PRINCIPLED, in);
}

bsdf::Closures closures_of(ProgramBuilder* b, const std::vector<int>& layers) {
  shading::ShadeContext context;
  context.wo = kWo;
  bsdf::Closures closures = run(b->compile(mixed(b, layers))->surface, context).closures;
  closures.finish(context.wo, context.geometric_normal, 0.1f);
  return closures;
}

bsdf::Closures equal_principled(int count) {
  ProgramBuilder b;
  std::vector<int> layers;
  for (int i = 0; i < count; i++) layers.push_back(rich_principled(&b, 0.5f));
  return closures_of(&b, layers);
}

TEST(ManyClosures, EqualPrincipledMixedKeepTheirAlbedo) {
  const bsdf::Closures one = equal_principled(1);
  for (const int count : {2, 3, 4, 16}) {
    const bsdf::Closures many = equal_principled(count);
    for (const bsdf::LightPass pass :
         {bsdf::LightPass::Diffuse, bsdf::LightPass::Glossy, bsdf::LightPass::Transmission})
      EXPECT_LE(max_component(glm::abs(many.albedo(pass, kWo) - one.albedo(pass, kWo))), 1e-5f) << count;
    const Vec3 wi = glm::normalize(Vec3(-0.4f, -0.2f, 0.9f));
    const Rgb f = one.evaluate(bsdf::ScatterClass::Diffuse, kWo, wi).value;
    EXPECT_LE(max_component(glm::abs(many.evaluate(bsdf::ScatterClass::Diffuse, kWo, wi).value - f)),
              1e-5f * max_component(f))
        << count;
  }
}

TEST(ManyClosures, PrincipledOfSeveralKindsKeepTheirAlbedo) {
  Rgb sum(0.0f);
  ProgramBuilder together;
  std::vector<int> layers;
  for (int i = 0; i < 6; i++) {
    const float roughness = 0.35f + 0.1f * static_cast<float>(i);
    layers.push_back(rich_principled(&together, roughness));
    ProgramBuilder alone;
    sum += closures_of(&alone, {rich_principled(&alone, roughness)}).albedo(kWo) / 6.0f;
  }
  const Rgb albedo = closures_of(&together, layers).albedo(kWo);
  for (int i = 0; i < 3; i++) EXPECT_NEAR(albedo[i], sum[i], 0.01f * sum[i]);
}

TEST(ManyClosures, ThirtyDiffuseLayersWithTheirOwnNormalsAreAsBrightAsOne) {
  for (const int count : {1, 13, 30}) {
    ProgramBuilder b;
    std::vector<int> layers;
    for (int i = 0; i < count; i++) {
      const auto angle = 2.4f * static_cast<float>(i);
      const Vec3 normal = glm::normalize(Vec3(0.3f * std::cos(angle), 0.3f * std::sin(angle), 1.0f));
      layers.push_back(b.add(GRADUS_OP_DIFFUSE, {In(0.8f), In(0.0f), In(normal)}));
    }
    const bsdf::Closures closures = closures_of(&b, layers);
    EXPECT_NEAR(closures.albedo(bsdf::LightPass::Diffuse, kWo).x, 0.8f, 1e-5f) << count;
    EXPECT_LE(closures.count(), bsdf::kMaxLobes);
  }
}

// Strong lobes keep their shape: a mirror among many weak rough lobes stays a mirror.
TEST(ManyClosures, AMirrorStaysOneAmongManyWeakLobes) {
  bsdf::Closures closures;
  for (int i = 0; i < 40; i++) {
    bsdf::Lobe* lobe = closures.add();
    lobe->type = bsdf::LobeType::GgxReflection;
    lobe->weight = Rgb(i == 0 ? 0.5f : 0.01f);
    lobe->alpha_x = lobe->alpha_y = i == 0 ? 0.0f : 0.2f + 0.01f * static_cast<float>(i);
  }
  closures.finish(kWo, Vec3(0, 0, 1), 0.1f);
  EXPECT_EQ(closures.lobe(0).type, bsdf::LobeType::DiracReflection);
  EXPECT_NEAR(closures.lobe(0).weight.x, 0.5f, 1e-6f);
}

// Lobes of one type that no single formula fits: their albedo is added to the stronger.
TEST(ManyClosures, CurvesOfFresnelThatDoNotMixKeepTheirAlbedo) {
  const Rgb before(0.04f + 0.2f);
  bsdf::Lobe coat, metal;
  coat.type = metal.type = bsdf::LobeType::GgxReflection;
  coat.weight = Rgb(1.0f);
  coat.fresnel = bsdf::FresnelType::Dielectric;
  coat.ior = 1.5f;
  coat.alpha_x = coat.alpha_y = metal.alpha_x = metal.alpha_y = 0.2f;
  metal.weight = Rgb(0.4f);
  metal.fresnel = bsdf::FresnelType::PrincipledMetal;
  metal.f0 = Rgb(0.5f);
  bsdf::Lobe both = bsdf::merged(coat, metal);
  const Rgb after = bsdf::lobe_albedo(&both, Vec3(0, 0, 1), Vec3(0, 0, 1));
  EXPECT_NEAR(after.x, before.x, 0.01f);
}

// Regression: f0 and f90 were mixed where they are reflectances in one lobe, and refractive index and extinction in the
// other, so that the merged lobe had a curve of neither: it rose 3.4 times at grazing angles, not twice.
TEST(ManyClosures, LobesOfOtherKindsDoNotChangeTheCurve) {
  bsdf::Lobe conductor, metal;
  conductor.type = metal.type = bsdf::LobeType::GgxReflection;
  conductor.alpha_x = conductor.alpha_y = metal.alpha_x = metal.alpha_y = 0.05f;
  conductor.weight = Rgb(1.0f);
  conductor.fresnel = bsdf::FresnelType::Conductor;
  conductor.f0 = Rgb(2.5f);
  conductor.f90 = Rgb(0.0f);
  metal.weight = Rgb(0.9f);
  metal.fresnel = bsdf::FresnelType::PrincipledMetal;
  metal.f0 = metal.f90 = Rgb(1.0f);
  // Returns by how much brighter the lobe is at an angle of 78 degrees.
  const auto rise = [](bsdf::Lobe lobe) {
    const Vec3 normal(0, 0, 1);
    const float head_on = bsdf::lobe_albedo(&lobe, normal, normal).x;
    return bsdf::lobe_albedo(&lobe, glm::normalize(Vec3(0.98f, 0.0f, 0.2f)), normal).x / head_on;
  };
  EXPECT_NEAR(rise(bsdf::merged(conductor, metal)), rise(conductor), 1e-3f * rise(conductor));
}

}  // namespace
}  // namespace gradus::test::many_closures_test
