// What every kind of lobe offers, in the lobe's own frame (z = normal, wo.z > 0 but for diffuse lobes with bumps).
#pragma once

#include "bsdf/closures.h"

namespace gradus::bsdf {

// Sides of the surface that an entry of a class scatters to.
enum : uint8_t { kReflects = 1, kTransmits = 2, kBothSides = 3 };

// f·|cos| of the given sides of one smooth lobe, weight included; density of `sample` with the same sides.
using EvaluateLobe = BsdfEval (*)(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
// u_side: chooses reflection or transmission where both are asked for. False: the sample is lost.
using SampleLobe = bool (*)(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

// Lambert's lobe needs no more than the cosine of wi and its normal.
inline bool is_lambert(const Lobe& lobe) {
  return lobe.type == LobeType::Diffuse && lobe.fresnel != FresnelType::Schlick && lobe.alpha_x <= 0.0f;
}
inline BsdfEval evaluate_lambert(const Lobe& lobe, float cos_i) {
  const float pdf = cos_i * kInvPi;
  return cos_i > 0.0f ? BsdfEval{lobe.weight * pdf, pdf} : BsdfEval{};
}

BsdfEval evaluate_diffuse(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_diffuse(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_translucent(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_translucent(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_sheen(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_sheen(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);
// Directional albedo without the weight.
float sheen_albedo(const Lobe& lobe, float cosine);

BsdfEval evaluate_ggx_reflection(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_ggx_reflection(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_ggx_refraction(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_ggx_refraction(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

BsdfEval evaluate_ggx_glass(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides);
bool sample_ggx_glass(const Lobe& lobe, const Vec3& wo, float u_side, const Vec2& u, uint8_t sides, Vec3* wi);

// Direction and coefficient (weight included) of one side of a Dirac lobe; false if that side does not exist from wo.
bool dirac_direction(const Lobe& lobe, const Vec3& wo, bool transmitted, Vec3* wi, Rgb* coefficient);

inline bool is_dirac(LobeType type) { return type >= LobeType::DiracReflection; }
inline bool is_microfacet(LobeType type) { return type >= LobeType::GgxReflection; }

// Turns the normal to the side of wo, limits what users can type, makes it Dirac where float demands it, fills
// `energy`.
void prepare_lobe(Lobe* lobe, const Vec3& geometric_normal, const Vec3& wo);

// What merging two lobes changes, after Ward ("Hierarchical Grouping to Optimize an Objective Function", 1963): 0 for
// equal shapes, little where one of them is weak; infinite for other kinds of lobes.
float merge_cost(const Lobe& a, const Lobe& b);
// One lobe for two that are not finished: the mean shape, and the albedo of both as seen along the normal.
Lobe merged(const Lobe& a, const Lobe& b);

// Directional albedo of both sides of a lobe, weight and energy compensation included, seen under the cosine of wo and
// the lobe's normal; lobe as after finish().
struct LobeAlbedo {
  Rgb reflected = Rgb(0.0f);
  Rgb transmitted = Rgb(0.0f);
};
LobeAlbedo two_sided_albedo(const Lobe& lobe, float cosine);
// Factor by which multiple scattering raises a microfacet lobe seen under `cosine`.
Rgb multiscatter_energy(const Lobe& lobe, float cosine);

}  // namespace gradus::bsdf
