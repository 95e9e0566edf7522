// Closure operations, which add lobes, emission and transparency to a result.
#pragma once

#include "shading/context.h"
#include "shading/ops.h"

namespace gradus::shading {

// Flag in the mode of PRINCIPLED, set by the compiler: only its emission is needed.
inline constexpr uint32_t kEmissionOnly = 1u << 16;

// Arguments of a closure operation: its operation code, the weight of its lobes, and its inputs.
struct ClosureArgs : OpArgs {
  uint32_t op = 0;
  Rgb weight = Rgb(1.0f);
};

// Runs the closure operation args.op.
void add_closure(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result);

// Returns the method of GradusSubsurface in the mode of an operation.
inline bsdf::SubsurfaceMethod subsurface_method(uint32_t mode) {
  return static_cast<bsdf::SubsurfaceMethod>((mode & (GRADUS_SUBSURFACE_ONCE - 1)) / GRADUS_SUBSURFACE_WALK);
}

// Light that enters the object below a surface.
struct Subsurface {
  uint32_t mode = 0;       // GradusSubsurface, and other modes of the operation
  Rgb weight = Rgb(0.0f);  // with the factor `color`
  Rgb color = Rgb(0.0f);
  Rgb radius = Rgb(0.0f);
  float ior = 1.4f;
  float alpha = 1.0f;  // of the interface
  float anisotropy = 0.0f;
  Vec3 normal = Vec3(0.0f);  // on the side of wo
  bool disney = false;       // the diffuse lobes are Disney's
};

// Adds the lobes of subsurface scattering. Channels whose radius is too small are diffuse, and so are all channels
// where is_diffuse_below() holds.
void add_subsurface(const Subsurface& inputs, ShadeResult* result, const ShadeContext& context);
// Returns whether the ray that arrives sees a diffuse surface instead of subsurface scattering with this mode.
bool is_diffuse_below(uint32_t mode, const RayState& ray);

// Defined in principled.cpp and principled_3.cpp.
void add_principled(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result);
void add_principled_3(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result);

// Closures with a smaller weight are omitted, as in Cycles.
inline constexpr float kWeightCutoff = 1e-5f;

// Returns the unit normal of an input. A zero input stands for the surface's own normal.
Vec3 input_normal(const ShadeContext& context, const Vec3& normal);
// Return the normal of a diffuse lobe, and of a lobe that reflects, refracts or lets light in. Where the input points
// below the surface, a diffuse lobe reflects nothing to the viewer's side, and another one takes the nearest normal
// whose mirror direction is above the surface, as in Cycles. The normal is 0 where a lobe scatters nothing: where it is
// below the surface and mirrors the viewer above it. Before Blender 3.6 diffuse lobes were treated like the others.
Vec3 diffuse_normal(const ShadeContext& context, const Vec3& normal);
Vec3 reflecting_normal(const ShadeContext& context, const Vec3& normal);
// Returns a normal on the viewer's side pointing out of the object, as lobes with two sides need it.
inline Vec3 pointing_outward(const ShadeContext& context, const Vec3& normal) {
  return context.backfacing ? -normal : normal;
}
// Puts a thin film with a thickness in nanometres on a microfacet lobe. Its Fresnel term, which is complete, becomes
// that of the film on it. Films that are too thin to be seen are left out.
void add_film(bsdf::Lobe* lobe, float thickness, float ior, bool fitted);
// Returns whether a film is thick enough to be seen.
inline bool has_film(float thickness) { return thickness > 0.1f; }
// Sets the alphas of a reflection lobe from a roughness and the anisotropy of the Principled BSDF, both in 0…1.
void set_principled_roughness(bsdf::Lobe* lobe, float roughness, float anisotropic);
// Sets the alphas of a reflection lobe from a roughness and the anisotropy of the Glossy BSDF, in -1…1.
void set_glossy_roughness(bsdf::Lobe* lobe, float roughness, float anisotropy);
// Returns the tangent of an input, rotated by `turns` full turns around the normal. A zero input stands for the default
// tangent.
Vec3 turned_tangent(const ShadeContext& context, const Vec3& tangent, const Vec3& normal, float turns);
// Return whether glossy lobes reflect, or refract, light towards the ray. They do not behind a diffuse bounce if
// caustics are off.
inline bool reflects(const ShadeContext& c) { return (c.ray.flags & kRayWithoutReflections) == 0; }
inline bool refracts(const ShadeContext& c) { return (c.ray.flags & kRayWithoutRefractions) == 0; }
// Removes the side of a glass lobe that makes caustics where those are off. Not both of them are.
void leave_caustics_out(const ShadeContext& context, bsdf::Lobe* glass);
// Adds a lobe and returns it, or returns null if its weight is below kWeightCutoff.
bsdf::Lobe* add_lobe(ShadeResult* result, bsdf::LobeType type, bsdf::LightPass pass, const Rgb& weight,
                     const Vec3& normal);
// Adds `value` to *sum, a member of the result, if it is finite. Otherwise one invalid emission would invalidate
// samples that also carry the light of other materials.
void add_finite(const Rgb& value, Rgb* sum, ShadeResult* result);
// Returns the weight of the layers below a layer with the given albedo.
Rgb layered(const Rgb& weight, const Rgb& albedo);

}  // namespace gradus::shading
