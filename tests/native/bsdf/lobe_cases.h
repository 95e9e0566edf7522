// Lobes that the statistical tests of closures share.
#pragma once

#include <string>
#include <vector>

#include "bsdf/closures.h"

namespace gradus::test {

struct LobeCase {
  std::string name;
  bsdf::Lobe lobe;
  bool lossless = false;  // the albedo is at least 0.99
  bool bounded = true;    // the albedo is at most 1; not for Disney's diffuse and velvet, which are kept for old files
  bool tabulated = true;  // the albedo is a table or closed form, and no estimate
};

inline bsdf::Lobe make_lobe(bsdf::LobeType type, float alpha = 0.0f,
                            bsdf::FresnelType fresnel = bsdf::FresnelType::None, float ior = 1.0f) {
  bsdf::Lobe lobe;
  lobe.type = type;
  lobe.fresnel = fresnel;
  lobe.weight = Rgb(1.0f);
  lobe.alpha_x = lobe.alpha_y = alpha;
  lobe.ior = ior;
  return lobe;
}

inline bsdf::Lobe toon_lobe(bsdf::LobeType type, float size, float smooth) {
  bsdf::Lobe lobe = make_lobe(type, size);
  lobe.alpha_y = smooth;
  return lobe;
}

// Returns the lobes that are not microfacets.
inline std::vector<LobeCase> diffuse_cases() {
  std::vector<LobeCase> cases = {
      {"Lambert", make_lobe(bsdf::LobeType::Diffuse), true},
      {"OrenNayar", make_lobe(bsdf::LobeType::Diffuse, 1.0f), false, true, false},
      {"EON", make_lobe(bsdf::LobeType::Diffuse, 1.0f), true},
      {"Disney", make_lobe(bsdf::LobeType::Diffuse, 0.5f, bsdf::FresnelType::Schlick), false, false},
      {"DisneyRough", make_lobe(bsdf::LobeType::Diffuse, 1.0f, bsdf::FresnelType::Schlick), false, false},
      {"Translucent", make_lobe(bsdf::LobeType::Translucent), true},
      {"Sheen", make_lobe(bsdf::LobeType::Sheen, 0.5f), false},
      {"SheenSmooth", make_lobe(bsdf::LobeType::Sheen, 0.1f), false},
      {"SheenGrazing", make_lobe(bsdf::LobeType::Sheen, 0.0f, bsdf::FresnelType::Schlick), false},
      {"Toon", toon_lobe(bsdf::LobeType::DiffuseToon, 0.8f, 0.0f), true},
      {"ToonSmooth", toon_lobe(bsdf::LobeType::DiffuseToon, 0.5f, 0.7f), false, true, false},
      {"GlossyToon", toon_lobe(bsdf::LobeType::GlossyToon, 0.3f, 0.0f), false, true, false},
      {"GlossyToonSmooth", toon_lobe(bsdf::LobeType::GlossyToon, 0.05f, 0.2f), false, true, false},
      {"Velvet", make_lobe(bsdf::LobeType::Velvet, 1.0f), false, false},
      {"VelvetSmooth", make_lobe(bsdf::LobeType::Velvet, 0.4f), false, false}};
  cases[2].lobe.multiscatter = true;
  return cases;
}

// Returns a lobe of each microfacet kind for a roughness (Blender's: alpha is its square).
inline std::vector<LobeCase> microfacet_cases(float roughness) {
  const float alpha = roughness * roughness;
  std::vector<LobeCase> cases = {
      {"Reflection", make_lobe(bsdf::LobeType::GgxReflection, alpha), false},
      {"ReflectionMultiscatter", make_lobe(bsdf::LobeType::GgxReflection, alpha), true},
      {"ReflectionDielectric", make_lobe(bsdf::LobeType::GgxReflection, alpha, bsdf::FresnelType::Dielectric, 1.5f),
       false},
      {"ReflectionSchlick", make_lobe(bsdf::LobeType::GgxReflection, alpha, bsdf::FresnelType::Schlick, 1.5f), false},
      {"ReflectionMetal", make_lobe(bsdf::LobeType::GgxReflection, alpha, bsdf::FresnelType::PrincipledMetal), false},
      {"Refraction", make_lobe(bsdf::LobeType::GgxRefraction, alpha, bsdf::FresnelType::None, 1.45f), false},
      {"Glass", make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::Dielectric, 1.5f), false},
      {"GlassInside", make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::Dielectric, 1.0f / 1.5f), false},
      {"GlassDense", make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::Dielectric, 3.0f), false},
      {"GlassMultiscatter", make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::Dielectric, 1.5f), true},
      {"GlassMultiscatterInside",
       make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::Dielectric, 1.0f / 1.5f), true},
      {"GlassWithoutStep", make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::Dielectric, 1.0f), true},
      {"Anisotropic", make_lobe(bsdf::LobeType::GgxReflection, alpha), false, true, false},
      {"BeckmannAnisotropic", make_lobe(bsdf::LobeType::BeckmannReflection, alpha), false, true, false},
      {"AshikhminShirleyAnisotropic", make_lobe(bsdf::LobeType::AshikhminShirley, alpha), false, true, false},
      {"Beckmann", make_lobe(bsdf::LobeType::BeckmannReflection, alpha), false, true, false},
      {"BeckmannRefraction", make_lobe(bsdf::LobeType::BeckmannRefraction, alpha, bsdf::FresnelType::None, 1.45f),
       false, true, false},
      {"BeckmannGlass", make_lobe(bsdf::LobeType::BeckmannGlass, alpha, bsdf::FresnelType::Dielectric, 1.5f), false,
       true, false},
      {"AshikhminShirley", make_lobe(bsdf::LobeType::AshikhminShirley, alpha), false, true, false},
      {"Conductor", make_lobe(bsdf::LobeType::GgxReflection, alpha, bsdf::FresnelType::Conductor), false},
      {"GlassFilm", make_lobe(bsdf::LobeType::GgxGlass, alpha, bsdf::FresnelType::FilmDielectric, 1.5f), false, true,
       false},
      {"MetalFilm", make_lobe(bsdf::LobeType::GgxReflection, alpha, bsdf::FresnelType::FilmMetal), false, true, false},
      {"ApproximateConductor", make_lobe(bsdf::LobeType::GgxReflection, alpha, bsdf::FresnelType::ApproximateConductor),
       false},
  };
  for (const size_t i : {size_t{12}, size_t{13}, size_t{14}}) {
    cases[i].lobe.alpha_x = alpha * 2.0f;
    cases[i].lobe.alpha_y = alpha * 0.5f;
  }
  cases[19].lobe.f0 = cases.back().lobe.f0 = Rgb(0.2f, 1.1f, 2.8f);
  cases[19].lobe.f90 = cases.back().lobe.f90 = Rgb(3.9f, 2.5f, 3.0f);
  cases[1].lobe.multiscatter = true;
  cases[3].lobe.f0 = Rgb(0.04f, 0.1f, 0.2f);
  cases[4].lobe.f0 = Rgb(0.9f, 0.6f, 0.3f);
  cases[4].lobe.f90 = Rgb(0.8f);
  cases[4].lobe.multiscatter = true;
  cases[9].lobe.multiscatter = true;
  cases[10].lobe.multiscatter = true;
  cases[20].lobe.f0 = Rgb(0.04f);
  cases[20].lobe.film = {400.0f, 1.33f, false};
  cases[21].lobe.f0 = Rgb(0.9f, 0.6f, 0.3f);
  cases[21].lobe.film = {400.0f, 1.33f, false};
  return cases;
}

// Normal of a shading frame that differs from the world's axes.
inline const Vec3 kTestNormal = glm::normalize(Vec3(0.3f, -0.5f, 0.8f));

inline Vec3 tilted_direction(float cosine, float azimuth) {
  const Vec3 x = glm::normalize(glm::cross(Vec3(0, 1, 0), kTestNormal));
  const Vec3 y = glm::cross(kTestNormal, x);
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  return glm::normalize(sine * std::cos(azimuth) * x + sine * std::sin(azimuth) * y + cosine * kTestNormal);
}

inline bsdf::Closures finished(bsdf::Lobe lobe, const Vec3& wo, float threshold = 0.1f) {
  bsdf::Closures closures;
  lobe.normal = kTestNormal;
  lobe.tangent = Vec3(0, 1, 0);
  *closures.add() = lobe;
  closures.finish(wo, kTestNormal, threshold);
  return closures;
}

}  // namespace gradus::test
