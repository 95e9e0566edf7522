// Functions of single lobes, grouped by type. Directions are in the lobe's frame, where z is the normal. wo.z is
// positive, except for diffuse lobes with bumps.
#pragma once

#include "base/fault.h"
#include "bsdf/closures.h"

namespace gradus::bsdf {

// Evaluates f·|cos| of the given sides of a smooth lobe, including its weight, and the density of the sampling function
// with the same sides.
using EvaluateLobe = BsdfEval (*)(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
// Samples a direction. `u_side` chooses reflection or transmission if both sides are given. Returns false if the sample
// is invalid.
using SampleLobe = bool (*)(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

inline bool is_lambert(const Lobe& lobe) {
  return lobe.type == LobeType::Diffuse && lobe.fresnel != FresnelType::Schlick && lobe.alpha_x <= 0.0f;
}
// Evaluates a Lambert lobe, for which the cosine of wi and the normal suffices.
inline BsdfEval evaluate_lambert(const Lobe& lobe, float cos_i) {
  const float pdf = cos_i * kInvPi;
  const float value = GRADUS_FAULT(lambert_without_cosine) ? kInvPi : pdf,
              density = GRADUS_FAULT(lambert_density_halved) ? 0.5f * pdf : pdf;
  return cos_i > 0.0f ? BsdfEval{lobe.weight * value, density} : BsdfEval{};
}

BsdfEval evaluate_diffuse(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_diffuse(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_translucent(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_translucent(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_sheen(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_sheen(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);
// Returns the directional albedo of a sheen lobe without its weight, for the cosine of wo.
float sheen_albedo(const Lobe& lobe, float cosine);

BsdfEval evaluate_toon(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_toon(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_velvet(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_velvet(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

// Computes the direction and the coefficient, including the weight, of one side of a Dirac lobe. Returns false if the
// lobe does not scatter wo to that side.
bool dirac_direction(const Lobe& lobe, const Vec3& wo, bool transmitted, Vec3* wi, Rgb* coefficient);

// Completes one lobe: flips its normal to the side of `geometric_normal` and wo, clamps its inputs to their ranges,
// makes it Dirac where floats cannot represent it, and sets `energy`. The normals of glossy and subsurface lobes, and
// with `tilts_diffuse` those of diffuse ones, are tilted until the mirror direction of wo is above the surface.
void prepare_lobe(Lobe* lobe, const Vec3& geometric_normal, const Vec3& wo, bool tilts_diffuse = false);

// Returns the cost of merging two lobes (Ward, "Hierarchical Grouping to Optimize an Objective Function", 1963). It is
// 0 for equal shapes, small if one of the lobes is weak, and large for lobes of different type or pass.
float merge_cost(const Lobe& a, const Lobe& b);
// Merges two lobes that are not finished into one with their mean shape and, at normal incidence, their total albedo.
// Lobes of different type or pass take the shape of the heavier one.
Lobe merged(const Lobe& a, const Lobe& b);

// Directional albedos of both sides of a lobe.
struct LobeAlbedo {
  Rgb reflected = Rgb(0.0f);
  Rgb transmitted = Rgb(0.0f);
};
// Returns the directional albedos of a finished lobe, including weight and energy compensation. `cosine` is that of wo
// and the lobe's normal.
LobeAlbedo two_sided_albedo(const Lobe& lobe, float cosine);
// Returns the directional albedos that Cycles estimates for its colour passes. They keep what single scattering loses.
LobeAlbedo shown_albedo(const Lobe& lobe, float cosine);
// Returns the factor by which multiple scattering raises a microfacet lobe, for the cosine of wo and the normal.
Rgb multiscatter_energy(const Lobe& lobe, float cosine);
// Returns whether the light of repeated bounces between microfacets leaves diffusely, as in Blender before 4.0, and
// does not scale the light of single bounces.
inline bool spreads_bounces(const Lobe& lobe) { return lobe.blur_conserves && lobe.fresnel == FresnelType::None; }
// Returns the value of repeated bounces for the cosines of wo and wi to the normal, with the factor of that of wi
// (Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks"). The lobe must be finished.
Rgb spread_bounces(const Lobe& lobe, float cos_o, float cos_i);

}  // namespace gradus::bsdf
