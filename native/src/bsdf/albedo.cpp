// Directional albedo of lobes, and the energy compensation of microfacet lobes that follows from it.
#include <cmath>

#include "bsdf/albedo_tables.h"
#include "bsdf/fresnel.h"
#include "bsdf/lobe.h"

namespace gradus::bsdf {
namespace {

// Returns the mean of both alphas, clamped at 1, because the albedo tables are isotropic. Cycles since Blender 4.0
// takes the geometric mean. Before, a random walk conserved all energy; an anisotropic lobe loses as much at one bounce
// as the isotropic lobe of the root mean square does.
float mean_alpha(const Lobe& lobe) {
  const float square = lobe.blur_conserves ? 0.5f * (lobe.alpha_x * lobe.alpha_x + lobe.alpha_y * lobe.alpha_y)
                                           : lobe.alpha_x * lobe.alpha_y;
  return std::min(1.0f, std::sqrt(square));
}

// Returns the dielectric Fresnel term averaged over the cosine-weighted hemisphere (fit of Kulla and Conty, "Revisiting
// Physically Based Shading at Imageworks", 2017).
float mean_dielectric(float eta) {
  if (eta < 1.0f) {
    return 0.997118f + eta * (0.1014f - eta * (0.965241f + 0.130607f * eta));
  }
  return (eta - 1.0f) / (4.08567f + 1.00071f * eta);
}

// Returns the F82 term averaged over the cosine-weighted hemisphere, by 2∫(1−c)^5 c dc = 1/21 and 2∫c(1−c)^6 c dc =
// 1/126.
Rgb mean_f82(const Rgb& f0, const Rgb& tint) {
  return f0 + (Rgb(1.0f) - f0) * (1.0f / 21.0f) - f82_factor(f0, tint) * (1.0f / 126.0f);
}

// Returns the albedo of a reflection lobe with the F82 term.
Rgb f82_albedo(const GgxMoments& m, const Rgb& f0, const Rgb& tint) {
  return glm::max(f0 * (m.one - m.schlick) + Rgb(m.schlick) - f82_factor(f0, tint) * m.f82, 0.0f);
}

// Returns the Fresnel term of a lobe averaged over the cosine-weighted hemisphere. It colours the light that bounces
// between microfacets.
Rgb mean_fresnel(const Lobe& lobe) {
  switch (lobe.fresnel) {
    case FresnelType::None:
      return lobe.f0;
    case FresnelType::Dielectric:
      return Rgb(mean_dielectric(lobe.ior));
    // A film changes the mean little.
    case FresnelType::FilmDielectric:
    case FresnelType::Schlick: {
      const float f0 = fresnel_f0(lobe.ior);
      const float s =
          f0 < 1e-6f ? 1.0f / 21.0f : std::clamp((mean_dielectric(lobe.ior) - f0) / (1.0f - f0), 0.0f, 1.0f);
      return glm::mix(lobe.f0, lobe.f90, s);
    }
    case FresnelType::FilmMetal:
    case FresnelType::PrincipledMetal:
      return mean_f82(lobe.f0, lobe.f90);
    case FresnelType::FilmConductor:
    case FresnelType::ApproximateConductor:
    case FresnelType::Conductor: {
      const F82Fit fit = fit_conductor(lobe);
      return mean_f82(fit.f0, fit.tint);
    }
  }
  return Rgb(1.0f);
}

// Returns the single-scattering albedo of the reflection side, without the lobe's weight.
Rgb single_reflection(const Lobe& lobe, float alpha, float cosine) {
  const bool two_sided = sides_of(lobe.type) == kBothSides;
  if (lobe.fresnel == FresnelType::Dielectric || (two_sided && lobe.fresnel == FresnelType::None)) {
    return Rgb(glass_albedo(alpha, cosine, lobe.ior).reflected);
  }
  const GgxMoments m = ggx_moments(alpha, cosine);
  switch (lobe.fresnel) {
    case FresnelType::Schlick: {
      const float f0 = fresnel_f0(lobe.ior);
      float position = m.schlick;
      if (f0 >= 1e-6f) {
        position =
            std::clamp((glass_albedo(alpha, cosine, lobe.ior).reflected - f0 * m.one) / (1.0f - f0), 0.0f, m.one);
      }
      return lobe.f0 * (m.one - position) + lobe.f90 * position;
    }
    case FresnelType::PrincipledMetal:
      return f82_albedo(m, lobe.f0, lobe.f90);
    case FresnelType::ApproximateConductor:
    case FresnelType::Conductor: {
      const F82Fit fit = fit_conductor(lobe);
      return f82_albedo(m, fit.f0, fit.tint);
    }
    case FresnelType::FilmDielectric:
    case FresnelType::FilmMetal:
    case FresnelType::FilmConductor:
      return m.one * fresnel_film(lobe, cosine);
    default:
      return Rgb(m.one);
  }
}

// Returns single_reflection(), from the lobe's cached value if that is for the same cosine and IOR.
Rgb reflected_once(const Lobe& lobe, float cosine) {
  const bool known = lobe.known.cosine == cosine && lobe.known.ior == lobe.ior;
  return known ? lobe.known.reflected : single_reflection(lobe, mean_alpha(lobe), cosine);
}

// Whether a lobe transmits without a Fresnel term, and so reflects nothing.
bool only_crosses(const Lobe& lobe) { return sides_of(lobe.type) == kTransmits && lobe.fresnel == FresnelType::None; }

// Returns whether what a lobe transmits follows from what it reflects: its Fresnel term is not that of a dielectric.
bool transmits_the_rest(const Lobe& lobe) {
  return lobe.fresnel == FresnelType::Schlick || lobe.fresnel == FresnelType::FilmDielectric;
}

// Returns the single-scattering albedo of the transmission side, without the lobe's weight. For glass with a Schlick
// term it is the dielectric albedo, scaled to the energy that the Schlick term does not reflect. `reflected` is
// single_reflection(), which is read if transmits_the_rest().
Rgb single_transmission(const Lobe& lobe, float alpha, float cosine, const Rgb& reflected) {
  const GlassAlbedo glass = glass_albedo(alpha, cosine, lobe.ior);
  if (only_crosses(lobe)) {
    return Rgb(glass.crossing) * lobe.transmission_tint;
  }
  if (transmits_the_rest(lobe) && glass.transmitted > 0.0f) {
    const Rgb share = (Rgb(glass.reflected + glass.transmitted) - reflected) / glass.transmitted;
    return glm::clamp(share, 0.0f, 1.0f / std::max(glass.transmitted, 1e-3f)) * glass.transmitted *
           lobe.transmission_tint;
  }
  return Rgb(glass.transmitted) * lobe.transmission_tint;
}

// Returns the factor of single scattering that adds the light of repeated bounces between microfacets. `single` and
// `mean` are the albedo without a Fresnel term and its mean, and `color` is the mean colour of a bounce (Turquin 2019,
// "Practical multiple scattering compensation for microfacet models", with the colour of Kulla and Conty 2017).
Rgb repeated_bounces(float single, float mean, const Rgb& color) {
  const float missing = (1.0f - single) / single;
  return Rgb(1.0f) + color * mean / (Rgb(1.0f) - color * (1.0f - mean)) * missing;
}

// Returns the albedo of single scattering without a Fresnel term, of both sides. The rest is lost between microfacets.
float colorless_albedo(const Lobe& lobe, float alpha, float cosine) {
  if (!(sides_of(lobe.type) & kTransmits)) return ggx_moments(alpha, cosine).one;
  const GlassAlbedo glass = glass_albedo(alpha, cosine, lobe.ior);
  return only_crosses(lobe) ? glass.crossing : glass.reflected + glass.transmitted;
}

// Returns the share of the reflected light in Cycles' estimate of the albedo, which leaves out the tint at 82 degrees
// and takes a conductor as smooth.
Rgb estimated_reflection(const Lobe& lobe, float cosine) {
  if (lobe.fresnel == FresnelType::Conductor || lobe.fresnel == FresnelType::ApproximateConductor) {
    return lobe_fresnel(lobe, cosine);
  }
  const GgxMoments m = ggx_moments(mean_alpha(lobe), cosine);
  if (lobe.fresnel == FresnelType::PrincipledMetal) return f82_albedo(m, lobe.f0, Rgb(1.0f)) / m.one;
  return reflected_once(lobe, cosine) / m.one;
}

LobeAlbedo dirac_albedo(const Lobe& lobe, float cosine) {
  const FresnelSplit split = lobe_fresnel_split(lobe, cosine);
  return {lobe.weight * split.reflected, lobe.weight * split.transmitted};
}

}  // namespace

Rgb multiscatter_energy(const Lobe& lobe, float cosine) {
  if (!lobe.multiscatter || is_dirac(lobe.type) || !is_microfacet(lobe.type)) {
    return Rgb(1.0f);
  }
  const float alpha = mean_alpha(lobe);
  if (sides_of(lobe.type) & kTransmits) {
    const float single = std::clamp(colorless_albedo(lobe, alpha, cosine), 0.3f, 1.0f);
    const Rgb color = glm::clamp(lobe.f90 * lobe.transmission_tint, 0.0f, 1.0f);
    if (only_crosses(lobe) || color == Rgb(1.0f)) {
      return Rgb(1.0f / single);
    }
    return repeated_bounces(single, glass_mean_albedo(alpha, lobe.ior), color);
  }
  const float single = std::clamp(colorless_albedo(lobe, alpha, cosine), 0.05f, 1.0f);
  Rgb color = glm::clamp(mean_fresnel(lobe), 0.0f, 1.0f);
  // Cycles before 4.0 multiplies by the colour of each repeated bounce once where it samples its walk, and twice where
  // it evaluates it for lights. The power between them is close to either.
  if (spreads_bounces(lobe)) color *= glm::sqrt(color);
  return repeated_bounces(single, ggx_mean_albedo(alpha), color);
}

Rgb spread_bounces(const Lobe& lobe, float cos_o, float cos_i) {
  const float alpha = mean_alpha(lobe);
  const float lost = 1.0f - ggx_moments(alpha, cos_i).one, mean_lost = 1.0f - ggx_mean_albedo(alpha);
  const Rgb energy = (lobe.energy - 1.0f) * ggx_moments(alpha, cos_o).one;
  return lobe.weight * energy * (lost * cos_i * kInvPi / std::max(mean_lost, 1e-4f));
}

LobeAlbedo two_sided_albedo(const Lobe& lobe, float signed_cosine) {
  const float cosine = std::min(std::abs(signed_cosine), 1.0f);
  const Rgb scale = lobe.weight * lobe.energy;
  switch (lobe.type) {
    case LobeType::Diffuse:
    case LobeType::DiffuseToon:
    case LobeType::GlossyToon:
    case LobeType::Velvet:
    case LobeType::Subsurface:
      return {lobe.weight, Rgb(0.0f)};
    case LobeType::Translucent:
      return {Rgb(0.0f), lobe.weight};
    case LobeType::Sheen:
      return {lobe.weight * sheen_albedo(lobe, std::max(signed_cosine, 0.0f)), Rgb(0.0f)};
    // The tables of GGX stand for the other distributions, too.
    case LobeType::GgxReflection:
    case LobeType::BeckmannReflection:
    case LobeType::AshikhminShirley:
      return {scale * reflected_once(lobe, cosine), Rgb(0.0f)};
    case LobeType::GgxRefraction:
    case LobeType::BeckmannRefraction:
    case LobeType::GgxGlass:
    case LobeType::BeckmannGlass: {
      const float alpha = mean_alpha(lobe);
      const bool reflects = (sides_of(lobe.type) & kReflects) != 0;
      const Rgb reflected = reflects || transmits_the_rest(lobe) ? single_reflection(lobe, alpha, cosine) : Rgb(0.0f);
      return {reflects ? scale * reflected : Rgb(0.0f), scale * single_transmission(lobe, alpha, cosine, reflected)};
    }
    default:
      return dirac_albedo(lobe, cosine);
  }
}

LobeAlbedo shown_albedo(const Lobe& lobe, float signed_cosine) {
  if (!is_microfacet(lobe.type) || is_dirac(lobe.type)) {
    return two_sided_albedo(lobe, signed_cosine);
  }
  const float cosine = std::min(std::abs(signed_cosine), 1.0f);
  const int sides = sides_of(lobe.type);
  const float kept = lobe.multiscatter ? colorless_albedo(lobe, mean_alpha(lobe), cosine) : 1.0f;
  const Rgb total = lobe.weight * lobe.energy * kept;  // energy is 1 without multiscatter
  const Rgb reflected = only_crosses(lobe) ? Rgb(0.0f) : glm::clamp(estimated_reflection(lobe, cosine), 0.0f, 1.0f);
  const Rgb transmitted = (Rgb(1.0f) - reflected) * lobe.transmission_tint;
  return {sides & kReflects ? total * reflected : Rgb(0.0f), sides & kTransmits ? total * transmitted : Rgb(0.0f)};
}

// As in Cycles, the albedo for layering ignores the energy that single scattering loses. Cycles' tables start at an IOR
// of 1, so a smaller IOR takes the albedo of its inverse.
Rgb lobe_albedo(Lobe* lobe, const Vec3& wo, const Vec3& geometric_normal) {
  Lobe prepared = *lobe;
  prepare_lobe(&prepared, geometric_normal, wo);
  const float cosine = glm::dot(prepared.normal, wo);
  float kept = 1.0f;
  if (is_microfacet(prepared.type) && !is_dirac(prepared.type) && sides_of(prepared.type) == kReflects) {
    prepared.ior =
        prepared.fresnel == FresnelType::Schlick ? std::max(prepared.ior, 1.0f / prepared.ior) : prepared.ior;
    kept = prepared.multiscatter ? 1.0f : ggx_moments(mean_alpha(prepared), cosine).one;
    const float seen = std::min(std::abs(cosine), 1.0f);
    prepared.known = lobe->known = {seen, prepared.ior, single_reflection(prepared, mean_alpha(prepared), seen)};
  }
  const LobeAlbedo albedo = two_sided_albedo(prepared, cosine);
  return (albedo.reflected + albedo.transmitted) / std::max(kept, 0.05f);
}

}  // namespace gradus::bsdf
