// Reflectance of thin films and conductors against closed forms.
#include <complex>

#include <gtest/gtest.h>

#include "bsdf/fresnel.h"
#include "bsdf/lobe_cases.h"

namespace gradus::test::thin_film_test {
namespace {

constexpr float kCosines[] = {1.0f, 0.7f, 0.3f, 0.05f};

bsdf::Lobe with_film(bsdf::FresnelType fresnel, float thickness, float ior) {
  bsdf::Lobe lobe = make_lobe(bsdf::LobeType::GgxReflection, 0.1f, fresnel, 1.8f);
  lobe.film = {thickness, ior, false};
  lobe.f0 = Rgb(bsdf::fresnel_f0(1.8f));
  return lobe;
}

void expect_near(const Rgb& a, const Rgb& b, float tolerance) {
  EXPECT_LE(max_component(glm::abs(a - b)), tolerance) << a.x << ' ' << a.y << ' ' << a.z << " expected " << b.x;
}

TEST(ThinFilm, OfTheIndexOfAirIsNotSeen) {
  for (const float cosine : kCosines) {
    bsdf::Lobe lobe = with_film(bsdf::FresnelType::FilmDielectric, 300.0f, 1.0f);
    expect_near(bsdf::fresnel_film(lobe, cosine), Rgb(bsdf::fresnel_dielectric(cosine, 1.8f)), 1e-5f);
    lobe = with_film(bsdf::FresnelType::FilmConductor, 300.0f, 1.0f);
    lobe.f0 = Rgb(0.2f, 1.1f, 2.8f);
    lobe.f90 = Rgb(3.9f, 2.5f, 3.0f);
    expect_near(bsdf::fresnel_film(lobe, cosine), bsdf::fresnel_conductor(cosine, lobe.f0, lobe.f90), 1e-4f);
    lobe = with_film(bsdf::FresnelType::FilmMetal, 300.0f, 1.0f);
    lobe.f0 = Rgb(0.9f, 0.6f, 0.3f);
    lobe.f90 = Rgb(0.7f, 0.8f, 0.9f);
    expect_near(bsdf::fresnel_film(lobe, cosine), bsdf::fresnel_f82(cosine, lobe.f0, lobe.f90), 2e-3f);
  }
}

TEST(ThinFilm, OfTheIndexOfTheBaseIsTheBase) {
  for (const float cosine : kCosines) {
    const bsdf::Lobe lobe = with_film(bsdf::FresnelType::FilmDielectric, 300.0f, 1.8f);
    expect_near(bsdf::fresnel_film(lobe, cosine), Rgb(bsdf::fresnel_dielectric(cosine, 1.8f)), 1e-5f);
  }
}

// Without interference the shares of the bounces add up. At normal incidence both polarisations are equal.
TEST(ThinFilm, DoesNotInterfereIfItIsThick) {
  const bsdf::Lobe lobe = with_film(bsdf::FresnelType::FilmDielectric, 5e4f, 1.3f);
  const float top = bsdf::fresnel_f0(1.3f), bottom = bsdf::fresnel_f0(1.8f / 1.3f);
  const float sum = top + (1.0f - top) * (1.0f - top) * bottom / (1.0f - top * bottom);
  expect_near(bsdf::fresnel_film(lobe, 1.0f), Rgb(sum), 1e-3f);
}

// A quarter of a wave of √n cancels the reflection of green light at normal incidence.
TEST(ThinFilm, OfAQuarterWaveIsDark) {
  const float index = std::sqrt(1.8f);
  const Rgb coated =
      bsdf::fresnel_film(with_film(bsdf::FresnelType::FilmDielectric, 545.0f / 4.0f / index, index), 1.0f);
  EXPECT_LT(coated.y, 0.003f);
  EXPECT_GT(coated.x, 2.0f * coated.y);
  EXPECT_GT(coated.z, 2.0f * coated.y);
}

TEST(Conductor, ReflectsAsFresnelsEquationsSay) {
  const Rgb n(0.2f, 1.1f, 2.8f), k(3.9f, 2.5f, 0.0f);
  for (const float cosine : kCosines) {
    const Rgb found = bsdf::fresnel_conductor(cosine, n, k);
    for (int i = 0; i < 3; i++) {
      const std::complex<double> index(n[i], k[i]);
      const double c = cosine;
      const std::complex<double> inside = std::sqrt(index * index - (1.0 - c * c));
      const double s = std::norm((c - inside) / (c + inside));
      const double p = std::norm((index * index * c - inside) / (index * index * c + inside));
      EXPECT_NEAR(found[i], 0.5 * (s + p), 1e-5) << cosine << ' ' << i;
    }
  }
}

// It is exact at normal incidence, and the error falls with the square of the index.
TEST(Conductor, ApproximationIsThatOfLargeIndices) {
  const auto error = [](float cosine, float scale) {
    const Rgb n = scale * Rgb(0.2f, 1.1f, 2.8f), k = scale * Rgb(3.9f, 2.5f, 0.5f);
    const Rgb off = bsdf::fresnel_conductor_approximately(cosine, n, k) - bsdf::fresnel_conductor(cosine, n, k);
    return glm::length(off);
  };
  EXPECT_LT(error(1.0f, 1.0f), 1e-6f);
  EXPECT_GT(error(0.3f, 1.0f), 1e-3f);
  EXPECT_LT(error(0.3f, 30.0f), 1e-3f * error(0.3f, 1.0f) + 1e-5f);
}

}  // namespace
}  // namespace gradus::test::thin_film_test
