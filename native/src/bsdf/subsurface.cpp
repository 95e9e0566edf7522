#include "bsdf/subsurface.h"

#include <algorithm>
#include <cmath>

#include "bsdf/ggx.h"
#include "bsdf/refract.h"
#include "bsdf/shading_frame.h"
#include "bsdf/warp.h"

namespace gradus::bsdf {

namespace {

// Guided walks are not defined for a medium that scatters less than this.
constexpr float kSmallestAlbedo = 0.2f;
constexpr float kLargestAlbedo = 0.999999f;

// Returns a polynomial with the given coefficients, the constant one first.
template <size_t N>
float polynomial(float x, const float (&c)[N]) {
  float sum = 0.0f;
  for (size_t i = N; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// The fit of Wrenninge et al. 2017 for a phase function of anisotropy g in [0, 1).
struct ChiangFit {
  float a, b, c, d, e, f;

  explicit ChiangFit(float g) {
    a = polynomial(g, {1.8260523782f, -1.28451056436f, -1.79904629312f, 9.19393289202f, -22.8215585862f, 32.0234874259f,
                       -23.6264803333f, 7.21067002658f});
    b = 4.98511194385f +
        0.127355959438f * std::exp(polynomial(g, {0.0f, 31.1491581433f, -201.847017512f, 841.576016723f,
                                                  -2018.09288505f, 2731.71560286f, -1935.41424244f, 559.009054474f}));
    c = polynomial(g, {1.09686102424f, -0.394704063468f, 1.05258115941f, -8.83963712726f, 28.8643230661f,
                       -46.8802913581f, 38.5402837518f, -12.7181042538f});
    d = polynomial(g, {0.496310210422f, 0.360146581622f, -2.15139309747f, 17.8896899217f, -55.2984010333f,
                       82.065982243f, -58.5106008578f, 15.8478295021f});
    e = 4.23190299701f +
        0.00310603949088f * std::exp(polynomial(g, {0.0f, 76.7316253952f, -594.356773233f, 2448.8834203f,
                                                    -5576.68528998f, 7116.60171912f, -4763.54467887f, 1303.5318055f}));
    f = polynomial(g, {2.40602999408f, -2.51814844609f, 9.18494908356f, -79.2191708682f, 259.082868209f,
                       -403.613804597f, 302.85712436f, -87.4370473567f});
  }

  // Returns the single-scattering albedo of a medium whose surface has the given albedo.
  float single_albedo(float albedo) const {
    const float blend = std::sqrt(std::sqrt(albedo));
    return (1.0f - blend) * a * std::pow(std::atan(b * albedo), c) + blend * d * std::pow(std::atan(e * albedo), f);
  }
};

// Returns the single-scattering albedo by d'Eon's fit for isotropic media, and similarity to those (van de Hulst 1974).
float de_hulst_albedo(float albedo, float g) {
  const float root = 4.20863f * albedo + 4.09712f - std::sqrt(9.59217f + albedo * (41.6808f + albedo * 17.7126f));
  const float s2 = root * root;
  const float divisor = 1.0f - g * s2;
  return divisor != 0.0f ? (1.0f - s2) / divisor : 0.0f;
}

// Returns the reflectance of Jensen's dipole for a reduced albedo, with 4A/3 of its boundary.
float dipole_reflectance(float albedo, float four_thirds_a) {
  const float s = std::sqrt(3.0f * (1.0f - albedo));
  return 0.5f * albedo * (1.0f + std::exp(-four_thirds_a * s)) * std::exp(-s);
}

// Returns the reduced albedo at which Jensen's dipole has the given reflectance. As in Cycles it takes twelve halvings
// of the interval.
float dipole_albedo(float reflectance, float four_thirds_a) {
  if (reflectance < 1e-4f) return 0.0f;
  if (reflectance >= 0.995f) return kLargestAlbedo;
  float low = 0.0f, high = 1.0f, middle = 0.5f;
  for (int i = 0; i < 12; ++i) {
    middle = 0.5f * (low + high);
    (dipole_reflectance(middle, four_thirds_a) < reflectance ? low : high) = middle;
  }
  return middle;
}

// Returns the factor from the radius of skin, the distance over which light spreads, to a mean free path (Jensen et al.
// 2001, "A Practical Model for Subsurface Light Transport").
Rgb skin_scale(const Rgb& color, float ior) {
  const float inverse = 1.0f / ior;
  const float internal = inverse * (0.710f - 1.440f * inverse) + 0.668f + 0.0636f * ior;
  const float four_thirds_a = 4.0f / 3.0f * (1.0f + internal) / (1.0f - internal);
  Rgb scale;
  for (int i = 0; i < 3; ++i) scale[i] = std::sqrt(3.0f * (1.0f - dipole_albedo(color[i], four_thirds_a)));
  return scale;
}

bool refract_into(const Lobe& lobe, const Vec3& wo, float alpha, const Vec2& u, Vec3* wi) {
  const Frame3 frame = make_frame(lobe.normal, perpendicular(lobe.normal));
  const Vec3 local = frame.to_local(wo);
  if (!(local.z > 0.0f)) return false;
  const Vec3 h = alpha > 0.0f ? Ggx{alpha, alpha}.sample_visible(local, u) : Vec3(0, 0, 1);
  Vec3 refracted;
  if (!refract_direction(local, h, lobe.ior, &refracted)) return false;
  *wi = frame.to_world(refracted);
  return true;
}

bool scatter_into(const Lobe& lobe, const Vec2& u, Vec3* wi) {
  *wi = -make_frame(lobe.normal, perpendicular(lobe.normal)).to_world(sample_cosine_hemisphere(u));
  return true;
}

}  // namespace

Medium medium_below(const Lobe& lobe, Rgb* weight) {
  Medium medium;
  const float g = medium.anisotropy = lobe.alpha_y;
  // The fit for anisotropic phase functions does not hold for backward scattering.
  const bool de_hulst = lobe.subsurface == SubsurfaceMethod::WalkDeHulst || g < 0.0f;
  const ChiangFit fit(de_hulst ? 0.0f : g);
  const Rgb paths = free_paths(lobe);
  for (int i = 0; i < 3; ++i) {
    const float path = std::max(paths[i], 1e-16f);
    medium.extinction[i] = 1.0f / (de_hulst ? path : path * (1.0f - g));
    const float color = lobe.f0[i];
    const float exact =
        std::clamp(de_hulst ? de_hulst_albedo(color, g) : fit.single_albedo(color), 0.0f, kLargestAlbedo);
    medium.albedo[i] = std::max(exact, kSmallestAlbedo);
    (*weight)[i] = color != 0.0f ? lobe.weight[i] / color * std::min(1.0f, exact / kSmallestAlbedo) : 0.0f;
  }
  return medium;
}

Rgb free_paths(const Lobe& lobe) {
  switch (lobe.subsurface) {
    case SubsurfaceMethod::WalkSkin:
    case SubsurfaceMethod::WalkDiffuseSkin:
      return lobe.f90 * skin_scale(lobe.f0, lobe.ior);
    case SubsurfaceMethod::WalkDeHulst:
      return lobe.f90;
    default:
      // The profiles of Burley and of walks look similar with this factor.
      return lobe.f90 * (0.25f * kInvPi);
  }
}

bool sample_entry(const Lobe& lobe, const Vec3& wo, const Vec2& u, Vec3* wi) {
  switch (lobe.subsurface) {
    case SubsurfaceMethod::WalkDiffuse:
    case SubsurfaceMethod::WalkDiffuseSkin:
      return scatter_into(lobe, u, wi);
    case SubsurfaceMethod::WalkSkin:
      return u.x < 0.5f ? scatter_into(lobe, Vec2(2.0f * u.x, u.y), wi)
                        : refract_into(lobe, wo, 1.0f, Vec2(2.0f * u.x - 1.0f, u.y), wi);
    default:
      return refract_into(lobe, wo, lobe.alpha_x, u, wi);
  }
}

void add_exit(const Lobe& entry, const Vec3& normal, Closures* closures) {
  Lobe* lobe = closures->add();
  lobe->type = LobeType::Diffuse;
  lobe->pass = LightPass::Diffuse;
  lobe->weight = Rgb(1.0f);
  lobe->normal = normal;
  lobe->fresnel = entry.fresnel;
  lobe->disney = DisneyPart::Exit;
}

}  // namespace gradus::bsdf
