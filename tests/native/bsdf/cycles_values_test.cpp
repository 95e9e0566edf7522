// A9 for closures: values that Cycles (Blender 4.5.15) gives for the same closure and directions.
// They are measured without noise: a unit sphere of 160,000 triangles under an orthographic camera along -Z, lit by one
// sun of 1 W/m2 with angle 0, 64 x 64 pixels, 1 sample, 0 bounces. The position of a pixel on the sphere is its normal;
// its value is f cos.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "bsdf/closures.h"
#include "bsdf/lobe_cases.h"

namespace gradus::test::cycles_values_test {
namespace {

struct Measured {
  std::string name;
  int x;
  int y;
  int sun;
  double value[3];
};

// clang-format off
const Measured kMeasured[] = {
    {"diffuse05", 32, 32, 0, {0.24945, 0.14549, 0.056049}},
    {"diffuse05", 44, 36, 0, {0.24471, 0.14402, 0.055766}},
    {"diffuse05", 20, 50, 0, {0.22868, 0.13748, 0.053869}},
    {"diffuse05", 14, 26, 0, {0.23739, 0.14123, 0.055017}},
    {"diffuse05", 32, 32, 1, {0.20261, 0.11875, 0.045876}},
    {"diffuse05", 44, 36, 1, {0.23436, 0.13664, 0.052628}},
    {"diffuse05", 20, 50, 1, {0.17434, 0.10533, 0.041384}},
    {"diffuse05", 14, 26, 1, {0.10355, 0.063398, 0.025086}},
    {"diffuse05", 32, 32, 2, {0.07431, 0.045155, 0.017796}},
    {"diffuse05", 44, 36, 2, {0.13151, 0.077653, 0.030124}},
    {"diffuse1", 32, 32, 0, {0.24458, 0.13442, 0.050102}},
    {"diffuse1", 44, 36, 0, {0.25409, 0.14299, 0.054057}},
    {"diffuse1", 20, 50, 0, {0.26094, 0.15345, 0.059464}},
    {"diffuse1", 14, 26, 0, {0.2591, 0.14928, 0.0572}},
    {"diffuse1", 32, 32, 1, {0.19635, 0.10876, 0.040732}},
    {"diffuse1", 44, 36, 1, {0.22245, 0.12162, 0.045187}},
    {"diffuse1", 20, 50, 1, {0.19309, 0.11425, 0.044422}},
    {"diffuse1", 14, 26, 1, {0.11674, 0.070623, 0.027784}},
    {"diffuse1", 32, 32, 2, {0.068493, 0.040525, 0.015757}},
    {"diffuse1", 44, 36, 2, {0.11161, 0.061714, 0.023087}},
    {"translucent", 32, 32, 3, {0.3086, 0.3086, 0.3086}},
    {"translucent", 44, 36, 3, {0.25269, 0.25269, 0.25269}},
    {"translucent", 20, 50, 3, {0.2317, 0.2317, 0.2317}},
    {"translucent", 14, 26, 3, {0.29462, 0.29462, 0.29462}},
    {"ggx03", 32, 32, 0, {8.7438, 8.7438, 8.7438}},
    {"ggx03", 44, 36, 0, {0.022064, 0.022064, 0.022064}},
    {"ggx03", 20, 50, 0, {0.0040076, 0.0040076, 0.0040076}},
    {"ggx03", 14, 26, 0, {0.0070359, 0.0070359, 0.0070359}},
    {"ggx03", 32, 32, 1, {0.080439, 0.080439, 0.080439}},
    {"ggx03", 44, 36, 1, {1.0329, 1.0329, 1.0329}},
    {"ggx03", 20, 50, 1, {0.0032063, 0.0032063, 0.0032063}},
    {"ggx03", 14, 26, 1, {0.0019354, 0.0019354, 0.0019354}},
    {"ggx03", 32, 32, 2, {0.0054941, 0.0054941, 0.0054941}},
    {"ggx03", 44, 36, 2, {0.049559, 0.049559, 0.049559}},
    {"ggx07", 32, 32, 0, {0.33047, 0.33047, 0.33047}},
    {"ggx07", 44, 36, 0, {0.14881, 0.14881, 0.14881}},
    {"ggx07", 20, 50, 0, {0.067675, 0.067675, 0.067675}},
    {"ggx07", 14, 26, 0, {0.091942, 0.091942, 0.091942}},
    {"ggx07", 32, 32, 1, {0.2033, 0.2033, 0.2033}},
    {"ggx07", 44, 36, 1, {0.32076, 0.32076, 0.32076}},
    {"ggx07", 20, 50, 1, {0.056294, 0.056294, 0.056294}},
    {"ggx07", 14, 26, 1, {0.032936, 0.032936, 0.032936}},
    {"ggx07", 32, 32, 2, {0.056744, 0.056744, 0.056744}},
    {"ggx07", 44, 36, 2, {0.17995, 0.17995, 0.17995}},
    {"mggx07", 32, 32, 0, {0.34907, 0.19492, 0.0704}},
    {"mggx07", 44, 36, 0, {0.15793, 0.088031, 0.031739}},
    {"mggx07", 20, 50, 0, {0.072094, 0.04013, 0.014448}},
    {"mggx07", 14, 26, 0, {0.097875, 0.054494, 0.019625}},
    {"mggx07", 32, 32, 1, {0.21474, 0.11991, 0.043309}},
    {"mggx07", 44, 36, 1, {0.34041, 0.18975, 0.068412}},
    {"mggx07", 20, 50, 1, {0.05997, 0.033381, 0.012018}},
    {"mggx07", 14, 26, 1, {0.035061, 0.019521, 0.0070302}},
    {"mggx07", 32, 32, 2, {0.059938, 0.033469, 0.012088}},
    {"mggx07", 44, 36, 2, {0.19097, 0.10645, 0.03838}},
    {"mggx1", 32, 32, 0, {0.25929, 0.25929, 0.25929}},
    {"mggx1", 44, 36, 0, {0.24455, 0.24455, 0.24455}},
    {"mggx1", 20, 50, 0, {0.21538, 0.21538, 0.21538}},
    {"mggx1", 14, 26, 0, {0.22971, 0.22971, 0.22971}},
    {"mggx1", 32, 32, 1, {0.2343, 0.2343, 0.2343}},
    {"mggx1", 44, 36, 1, {0.25319, 0.25319, 0.25319}},
    {"mggx1", 20, 50, 1, {0.19186, 0.19186, 0.19186}},
    {"mggx1", 14, 26, 1, {0.13455, 0.13455, 0.13455}},
    {"mggx1", 32, 32, 2, {0.12594, 0.12594, 0.12594}},
    {"mggx1", 44, 36, 2, {0.19731, 0.19731, 0.19731}},
    {"refr05", 32, 32, 3, {0.55069, 0.55069, 0.55069}},
    {"refr05", 44, 36, 3, {0.18097, 0.18097, 0.18097}},
    {"refr05", 20, 50, 3, {0.34142, 0.34142, 0.34142}},
    {"refr05", 14, 26, 3, {23.702, 23.702, 23.702}},
    {"glass05", 32, 32, 0, {0.042338, 0.042338, 0.042338}},
    {"glass05", 44, 36, 0, {0.0036474, 0.0036474, 0.0036474}},
    {"glass05", 20, 50, 0, {0.00090342, 0.00090342, 0.00090342}},
    {"glass05", 14, 26, 0, {0.0014689, 0.0014689, 0.0014689}},
    {"glass05", 32, 32, 1, {0.0086099, 0.0086099, 0.0086099}},
    {"glass05", 44, 36, 1, {0.02913, 0.02913, 0.02913}},
    {"glass05", 20, 50, 1, {0.00073366, 0.00073366, 0.00073366}},
    {"glass05", 14, 26, 1, {0.00043288, 0.00043288, 0.00043288}},
    {"glass05", 32, 32, 2, {0.0011607, 0.0011607, 0.0011607}},
    {"glass05", 44, 36, 2, {0.0069929, 0.0069929, 0.0069929}},
    {"glass05", 32, 32, 3, {0.52974, 0.52974, 0.52974}},
    {"glass05", 44, 36, 3, {0.17409, 0.17409, 0.17409}},
    {"glass05", 20, 50, 3, {0.32843, 0.32843, 0.32843}},
    {"glass05", 14, 26, 3, {22.8, 22.8, 22.8}},
    {"mglass05", 32, 32, 0, {0.04266, 0.04266, 0.04266}},
    {"mglass05", 44, 36, 0, {0.0036845, 0.0036845, 0.0036845}},
    {"mglass05", 20, 50, 0, {0.00092038, 0.00092038, 0.00092038}},
    {"mglass05", 14, 26, 0, {0.0014894, 0.0014894, 0.0014894}},
    {"mglass05", 32, 32, 1, {0.0086754, 0.0086754, 0.0086754}},
    {"mglass05", 44, 36, 1, {0.029427, 0.029427, 0.029427}},
    {"mglass05", 20, 50, 1, {0.00074743, 0.00074743, 0.00074743}},
    {"mglass05", 14, 26, 1, {0.00043893, 0.00043893, 0.00043893}},
    {"mglass05", 32, 32, 2, {0.0011695, 0.0011695, 0.0011695}},
    {"mglass05", 44, 36, 2, {0.007064, 0.007064, 0.007064}},
    {"mglass05", 32, 32, 3, {0.53377, 0.53377, 0.53377}},
    {"mglass05", 44, 36, 3, {0.17586, 0.17586, 0.17586}},
    {"mglass05", 20, 50, 3, {0.33459, 0.33459, 0.33459}},
    {"mglass05", 14, 26, 3, {23.119, 23.119, 23.119}},
    {"mglass1", 32, 32, 0, {0.0029797, 0.0029797, 0.0029797}},
    {"mglass1", 44, 36, 0, {0.0030667, 0.0030667, 0.0030667}},
    {"mglass1", 20, 50, 0, {0.0032915, 0.0032915, 0.0032915}},
    {"mglass1", 14, 26, 0, {0.0031771, 0.0031771, 0.0031771}},
    {"mglass1", 32, 32, 1, {0.0027047, 0.0027047, 0.0027047}},
    {"mglass1", 44, 36, 1, {0.0031894, 0.0031894, 0.0031894}},
    {"mglass1", 20, 50, 1, {0.0029453, 0.0029453, 0.0029453}},
    {"mglass1", 14, 26, 1, {0.0018694, 0.0018694, 0.0018694}},
    {"mglass1", 32, 32, 2, {0.0015858, 0.0015858, 0.0015858}},
    {"mglass1", 44, 36, 2, {0.0027111, 0.0027111, 0.0027111}},
    {"mglass1", 32, 32, 3, {1.8057, 1.8057, 1.8057}},
    {"mglass1", 44, 36, 3, {1.7591, 1.7591, 1.7591}},
    {"mglass1", 20, 50, 3, {2.0194, 2.0194, 2.0194}},
    {"mglass1", 14, 26, 3, {2.0744, 2.0744, 2.0744}},
    {"metal05", 32, 32, 0, {1.2183, 0.79248, 0.38687}},
    {"metal05", 44, 36, 0, {0.1057, 0.068603, 0.033416}},
    {"metal05", 20, 50, 0, {0.026657, 0.017204, 0.0083322}},
    {"metal05", 14, 26, 0, {0.042932, 0.027789, 0.0135}},
    {"metal05", 32, 32, 1, {0.24664, 0.16043, 0.078319}},
    {"metal05", 44, 36, 1, {0.84041, 0.54544, 0.26568}},
    {"metal05", 20, 50, 1, {0.02155, 0.013908, 0.006736}},
    {"metal05", 14, 26, 1, {0.012595, 0.0081523, 0.0039603}},
    {"metal05", 32, 32, 2, {0.030478, 0.019828, 0.0096841}},
    {"metal05", 44, 36, 2, {0.18492, 0.12004, 0.058496}},
};
// clang-format on

const Vec3 kSuns[] = {Vec3(0, 0, 1), Vec3(0.5f, 0.3f, 0.81f), Vec3(0.9f, -0.2f, 0.3f), Vec3(0.2f, 0.1f, -0.97f)};

bsdf::Lobe coloured(bsdf::Lobe lobe) {
  lobe.weight = lobe.f0 = Rgb(0.8f, 0.5f, 0.2f);
  lobe.multiscatter = true;
  return lobe;
}

bsdf::Lobe multiscatter(bsdf::LobeType type, float roughness, bsdf::FresnelType fresnel, float ior) {
  bsdf::Lobe lobe = make_lobe(type, roughness * roughness, fresnel, ior);
  lobe.multiscatter = true;
  return lobe;
}

bsdf::Lobe lobe_of(const std::string& name) {
  if (name == "diffuse05") return coloured(make_lobe(bsdf::LobeType::Diffuse, 0.5f));
  if (name == "diffuse1") return coloured(make_lobe(bsdf::LobeType::Diffuse, 1.0f));
  if (name == "translucent") return make_lobe(bsdf::LobeType::Translucent);
  if (name == "ggx03") return make_lobe(bsdf::LobeType::GgxReflection, 0.09f);
  if (name == "ggx07") return make_lobe(bsdf::LobeType::GgxReflection, 0.49f);
  if (name == "mggx1") return multiscatter(bsdf::LobeType::GgxReflection, 1.0f, bsdf::FresnelType::None, 1.0f);
  if (name == "refr05") return make_lobe(bsdf::LobeType::GgxRefraction, 0.25f, bsdf::FresnelType::None, 1.45f);
  if (name == "glass05") return make_lobe(bsdf::LobeType::GgxGlass, 0.25f, bsdf::FresnelType::Dielectric, 1.45f);
  if (name == "mglass05") return multiscatter(bsdf::LobeType::GgxGlass, 0.5f, bsdf::FresnelType::Dielectric, 1.45f);
  if (name == "mglass1") return multiscatter(bsdf::LobeType::GgxGlass, 1.0f, bsdf::FresnelType::Dielectric, 1.45f);
  bsdf::Lobe metal = multiscatter(bsdf::LobeType::GgxReflection, 0.5f, bsdf::FresnelType::PrincipledMetal, 1.0f);
  metal.f0 = Rgb(0.9f, 0.6f, 0.3f);
  metal.f90 = Rgb(0.7f, 0.8f, 0.9f);
  if (name == "metal05") return metal;
  // The Glossy node with a colour, which multiplies each bounce between microfacets.
  bsdf::Lobe glossy = multiscatter(bsdf::LobeType::GgxReflection, 0.7f, bsdf::FresnelType::None, 1.0f);
  glossy.weight = glossy.f0 = Rgb(0.8f, 0.5f, 0.2f);
  return glossy;
}

TEST(A9_CyclesClosures, ValuesAgree) {
  const Vec3 wo(0, 0, 1);
  for (const Measured& m : kMeasured) {
    const float x = (static_cast<float>(m.x) + 0.5f) / 32.0f - 1.0f;
    const float y = (static_cast<float>(m.y) + 0.5f) / 32.0f - 1.0f;
    const Vec3 normal(x, y, std::sqrt(1.0f - x * x - y * y));
    bsdf::Closures closures;
    bsdf::Lobe lobe = lobe_of(m.name);
    lobe.normal = normal;
    *closures.add() = lobe;
    closures.finish(wo, normal, 0.1f);
    Rgb value(0.0f);
    for (int c = 0; c < bsdf::kScatterClasses; c++) {
      value += closures.evaluate(static_cast<bsdf::ScatterClass>(c), wo, glm::normalize(kSuns[m.sun])).value;
    }
    for (int c = 0; c < 3; c++) {
      EXPECT_NEAR(static_cast<double>(value[c]), m.value[c], 0.005 * m.value[c] + 1e-5)
          << m.name << ' ' << m.x << ' ' << m.y << " sun " << m.sun;
    }
  }
}

// A white Lambertian closure with its normal tilted by (0.4, 0.2, 0), lit from the side.
TEST(A9_CyclesClosures, BumpsDarkenSoftly) {
  const struct {
    int x;
    float value;
  } measured[] = {{20, 0.0f}, {23, 0.0517f}, {29, 0.1517f}, {41, 0.2356f}, {56, 0.2917f}};
  const Vec3 wo(0, 0, 1);
  for (const auto& m : measured) {
    const float x = (static_cast<float>(m.x) + 0.5f) / 32.0f - 1.0f;
    const float y = 0.5f / 32.0f;
    const Vec3 normal(x, y, std::sqrt(1.0f - x * x - y * y));
    bsdf::Closures closures;
    bsdf::Lobe lobe = make_lobe(bsdf::LobeType::Diffuse);
    lobe.normal = glm::normalize(normal + Vec3(0.4f, 0.2f, 0.0f));
    *closures.add() = lobe;
    closures.finish(wo, normal, 0.1f, normal);
    EXPECT_NEAR(closures.evaluate(bsdf::ScatterClass::Diffuse, wo, glm::normalize(kSuns[2])).value.x, m.value, 2e-4f)
        << m.x;
  }
}

// As in Blender before 4.5, the factor is g + g² − g³ of the ratio g of cosines, where the bump faces away from the
// surface more than the light does.
TEST(A9_CyclesClosures, OldBumpsDarkenByARatioOfCosines) {
  const Vec3 smooth(0, 0, 1), wo = glm::normalize(Vec3(0.3f, 0.0f, 1.0f));
  const Vec3 bumped = glm::normalize(Vec3(0.5f, 0.0f, 1.0f));
  for (const float x : {-0.6f, 0.4f, 3.0f}) {
    const Vec3 wi = glm::normalize(Vec3(x, 0.2f, 1.0f));
    bsdf::Closures closures;
    bsdf::Lobe lobe = make_lobe(bsdf::LobeType::Diffuse);
    lobe.normal = bumped;
    *closures.add() = lobe;
    closures.set_shading_normals(GRADUS_SHADING_NORMALS_SINCE_3_6);
    closures.finish(wo, smooth, 0.1f, smooth);
    const float cosine = glm::dot(wi, bumped);
    const float g = std::min(wi.z / (cosine * bumped.z), 1.0f);
    const float expected = cosine * kInvPi * (g + g * g - g * g * g);
    EXPECT_NEAR(closures.evaluate(bsdf::ScatterClass::Diffuse, wo, wi).value.x, expected, 1e-6f) << x;
  }
}

// Before Blender 3.6, the normal of a diffuse closure follows wo where its mirror direction would be below the surface.
TEST(A9_CyclesClosures, OldDiffuseNormalsKeepMirrorDirectionsAbove) {
  const Vec3 smooth(0, 0, 1), bumped = glm::normalize(Vec3(-1.0f, 0.0f, 1.0f));
  const Vec3 wo = glm::normalize(Vec3(1.0f, 0.0f, 0.3f));
  bsdf::Closures closures;
  bsdf::Lobe lobe = make_lobe(bsdf::LobeType::Diffuse);
  lobe.normal = bumped;
  *closures.add() = lobe;
  closures.finish(wo, smooth, 0.1f, smooth);
  EXPECT_TRUE(closures.ignores_wo());
  EXPECT_EQ(closures.lobe(0).normal, bumped);
  closures.set_shading_normals(GRADUS_SHADING_NORMALS_BEFORE_3_6);
  closures.finish(wo, smooth, 0.1f, smooth);
  EXPECT_FALSE(closures.ignores_wo());
  const Vec3 normal = closures.lobe(0).normal;
  EXPECT_NEAR(2.0f * glm::dot(normal, wo) * normal.z - wo.z, std::min(0.9f * wo.z, 0.01f), 1e-4f);
}

}  // namespace
}  // namespace gradus::test::cycles_values_test
