// Closure operations: fill lobes, emission and transparency.
#pragma once

#include "shading/context.h"
#include "shading/ops.h"

namespace gradus::shading {

// Bits that compile adds to the mode of PRINCIPLED: only its emission is wanted.
inline constexpr uint32_t kEmissionOnly = 1u << 16;

struct ClosureArgs : OpArgs {
  uint32_t op = 0;
  Rgb weight = Rgb(1.0f);
};

void add_closure(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result);

// principled.cpp, principled_3.cpp
void add_principled(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result);
void add_principled_3(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result);

// Helpers for both.
inline constexpr float kWeightCutoff = 1e-5f;  // closures below are left out, as in Cycles

// Direction towards the viewer's side; zero: the surface's own normal.
Vec3 facing_normal(const ShadeContext& context, const Vec3& normal);
// The same, pointing outwards, as lobes with two sides want it.
Vec3 outward_normal(const ShadeContext& context, const Vec3& normal);
// Widths of a reflection lobe from roughness and Principled's anisotropy (0…1).
void set_principled_roughness(bsdf::Lobe* lobe, float roughness, float anisotropic);
// The same for the Glossy BSDF, whose anisotropy runs from -1 to 1.
void set_glossy_roughness(bsdf::Lobe* lobe, float roughness, float anisotropy);
// Tangent (zero: the default one), turned by `turns` around the normal.
Vec3 turned_tangent(const ShadeContext& context, const Vec3& tangent, const Vec3& normal, float turns);
// A new lobe with the given weight; nullptr: too weak.
bsdf::Lobe* add_lobe(ShadeResult* result, bsdf::LobeType type, bsdf::LightPass pass, const Rgb& weight,
                     const Vec3& normal);
// Broken inputs must not cost the light of others, which shares its samples (architecture rule 2): what is not finite
// is black.
void add_finite(const Rgb& value, Rgb* sum);
// What is left for the layers below one of the given albedo.
Rgb layered(const Rgb& weight, const Rgb& albedo);

}  // namespace gradus::shading
