#include "shading/closure_ops.h"

#include "bsdf/fresnel.h"
#include "bsdf/shading_normal.h"
#include "shading/context_ops.h"
#include "shading/material.h"
#include "shading/rotation.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Radii below this are too small for a walk: light leaves where it enters.
constexpr float kSmallestRadius = 1e-8f;

// Mode of GLOSSY, REFRACTION and GLASS: as in Blender before 4.0. Mode of METALLIC: a conductor,
// and its Fresnel term before 5.0.
constexpr uint32_t kLegacy = 4, kConductor = 4, kApproximate = 8;

// Returns the GradusDistribution in the mode of an operation.
uint32_t distribution_of(const ClosureArgs& args) { return args.mode & 3; }

bsdf::LobeType reflection_type(const ClosureArgs& args) {
  switch (distribution_of(args)) {
    case GRADUS_DISTRIBUTION_BECKMANN:
      return bsdf::LobeType::BeckmannReflection;
    case GRADUS_DISTRIBUTION_ASHIKHMIN_SHIRLEY:
      return bsdf::LobeType::AshikhminShirley;
    default:
      return bsdf::LobeType::GgxReflection;
  }
}

bsdf::LobeType refraction_type(const ClosureArgs& args) {
  const bool beckmann = distribution_of(args) == GRADUS_DISTRIBUTION_BECKMANN;
  return beckmann ? bsdf::LobeType::BeckmannRefraction : bsdf::LobeType::GgxRefraction;
}

bsdf::LobeType glass_type(const ClosureArgs& args) {
  const bool beckmann = distribution_of(args) == GRADUS_DISTRIBUTION_BECKMANN;
  return beckmann ? bsdf::LobeType::BeckmannGlass : bsdf::LobeType::GgxGlass;
}

bool is_multiscatter(const ClosureArgs& args) { return distribution_of(args) == GRADUS_DISTRIBUTION_MULTIPLE; }

// Returns whether multiple scattering conserves energy under Filter Glossy, too, as before Blender 4.0.
bool has_legacy_blur(const ClosureArgs& args) { return (args.mode & kLegacy) && is_multiscatter(args); }
bool has_separable_masking(const ClosureArgs& args) { return (args.mode & kLegacy) && !is_multiscatter(args); }

Rgb non_negative(const Vec3& c) { return glm::max(c, Vec3(0.0f)); }

void add_diffuse(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  const Rgb color = non_negative(args.v(0));
  bsdf::Lobe* lobe = add_lobe(result, bsdf::LobeType::Diffuse, bsdf::LightPass::Diffuse, args.weight * color,
                              diffuse_normal(c, args.v(2)));
  if (!lobe) return;
  lobe->alpha_x = saturate(args.f(1));
  lobe->multiscatter = args.mode == 1;
  lobe->f0 = color;
}

void add_glossy(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  if (!reflects(c)) return;
  const Vec3 normal = reflecting_normal(c, args.v(4));
  bsdf::Lobe* lobe =
      add_lobe(result, reflection_type(args), bsdf::LightPass::Glossy, args.weight * non_negative(args.v(0)), normal);
  if (!lobe) return;
  set_glossy_roughness(lobe, args.f(1), args.f(2));
  if (args.f(2) != 0.0f) lobe->tangent = turned_tangent(c, args.v(5), normal, args.f(3));
  lobe->multiscatter = is_multiscatter(args);
  lobe->separable_masking = has_separable_masking(args);
  lobe->blur_conserves = has_legacy_blur(args);
  lobe->f0 = non_negative(args.v(0));
}

void add_metallic(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  if (!reflects(c)) return;
  const Vec3 normal = reflecting_normal(c, args.v(5));
  bsdf::Lobe* lobe = add_lobe(result, reflection_type(args), bsdf::LightPass::Glossy, args.weight, normal);
  if (!lobe) return;
  set_principled_roughness(lobe, args.f(2), args.f(3));
  if (args.f(3) > 0.0f) lobe->tangent = turned_tangent(c, args.v(6), normal, args.f(4));
  lobe->multiscatter = is_multiscatter(args);
  if (args.mode & kConductor) {
    const bool exact = (args.mode & kApproximate) == 0;
    lobe->fresnel = exact ? bsdf::FresnelType::Conductor : bsdf::FresnelType::ApproximateConductor;
    lobe->f0 = non_negative(args.v(0));
    lobe->f90 = non_negative(args.v(1));
  } else {
    lobe->fresnel = bsdf::FresnelType::PrincipledMetal;
    lobe->f0 = glm::clamp(args.v(0), 0.0f, 1.0f);
    lobe->f90 = glm::clamp(args.v(1), 0.0f, 1.0f);
  }
  add_film(lobe, args.f(7), args.f(8), false);
}

void add_refraction(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  if (!refracts(c)) return;
  bsdf::Lobe* lobe =
      add_lobe(result, refraction_type(args), bsdf::LightPass::Transmission, args.weight * non_negative(args.v(0)),
               pointing_outward(c, reflecting_normal(c, args.v(3))));
  if (!lobe) return;
  const float roughness = saturate(args.f(1));
  lobe->alpha_x = lobe->alpha_y = roughness * roughness;
  lobe->separable_masking = has_separable_masking(args);
  lobe->ior = std::max(args.f(2), 1e-5f);
}

// Adds the glass of Blender before 4.0, where the Fresnel term of the shading normal, not of the microfacets, weights
// reflection and refraction.
void add_legacy_glass(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  const Vec3 normal = reflecting_normal(c, args.v(3));
  const Rgb weight = args.weight * non_negative(args.v(0));
  const float ior = std::max(args.f(2), 1e-5f), roughness = saturate(args.f(1));
  const float reflected = dielectric_reflectance(glm::dot(c.wo, normal), c.backfacing ? 1.0f / ior : ior);
  const Rgb reflection = reflects(c) ? weight * reflected : Rgb(0.0f);
  const Rgb refraction = refracts(c) ? weight * (1.0f - reflected) : Rgb(0.0f);
  if (bsdf::Lobe* lobe = add_lobe(result, reflection_type(args), bsdf::LightPass::Glossy, reflection, normal)) {
    lobe->alpha_x = lobe->alpha_y = roughness * roughness;
    lobe->separable_masking = true;
  }
  if (bsdf::Lobe* lobe = add_lobe(result, refraction_type(args), bsdf::LightPass::Transmission, refraction,
                                  pointing_outward(c, normal))) {
    lobe->alpha_x = lobe->alpha_y = roughness * roughness;
    lobe->separable_masking = true;
    lobe->ior = ior;
  }
}

void add_glass(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  if ((args.mode & kLegacy) && !is_multiscatter(args) && args.f(1) > 0.0f) return add_legacy_glass(args, c, result);
  if (!reflects(c) && !refracts(c)) return;
  bsdf::Lobe* lobe =
      add_lobe(result, glass_type(args), bsdf::LightPass::Transmission, args.weight * non_negative(args.v(0)),
               pointing_outward(c, reflecting_normal(c, args.v(3))));
  if (!lobe) return;
  const float roughness = saturate(args.f(1));
  lobe->alpha_x = lobe->alpha_y = roughness * roughness;
  lobe->ior = std::max(args.f(2), 1e-5f);
  lobe->fresnel = bsdf::FresnelType::Dielectric;
  lobe->multiscatter = is_multiscatter(args);
  lobe->f90 = non_negative(args.v(0));
  add_film(lobe, args.f(4), args.f(5), false);
  lobe->blur_conserves = has_legacy_blur(args);
  // Before 4.0, glass with multiple scattering was left out as a whole or not at all.
  if (!has_legacy_blur(args)) leave_caustics_out(c, lobe);
}

void add_subsurface_node(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  Subsurface s;
  s.mode = args.mode;
  s.color = non_negative(args.v(0));
  s.weight = args.weight * s.color;
  s.radius = args.v(2) * args.f(1);
  s.ior = args.f(3);
  s.alpha = saturate(args.f(4));
  s.anisotropy = args.f(5);
  s.normal = reflecting_normal(c, args.v(6));
  add_subsurface(s, result, c);
}

void add_velvet(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  bsdf::Lobe* lobe = add_lobe(result, bsdf::LobeType::Velvet, bsdf::LightPass::Glossy,
                              args.weight * non_negative(args.v(0)), diffuse_normal(c, args.v(2)));
  if (lobe) lobe->alpha_x = std::clamp(args.f(1), 0.01f, 1.0f);
}

// Adds a portal. A surface has one; of several the last one remains.
void add_portal(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  const Rgb weight = args.weight * non_negative(args.v(0));
  if (!(max_component(weight) > kWeightCutoff) || !is_finite(weight)) return;
  const Vec3 direction = safe_normalize(args.v(2));
  result->portal.weight = weight;
  result->portal.direction = direction == Vec3(0.0f) ? -c.wo : direction;
  result->portal.origin = args.mode == 0 || !c.scene ? c.position : args.v(1) - c.scene->origin;
  const Vec3 moved = result->portal.origin - c.position;
  result->portal.is_elsewhere = glm::dot(moved, moved) > 1e-9f;
}

void add_sheen(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  if (args.mode == 1) return add_velvet(args, c, result);
  bsdf::Lobe* lobe = add_lobe(result, bsdf::LobeType::Sheen, bsdf::LightPass::Diffuse,
                              args.weight * non_negative(args.v(0)), diffuse_normal(c, args.v(2)));
  if (lobe) lobe->alpha_x = saturate(args.f(1));
}

void add_toon(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  const bool glossy = args.mode == 1;
  if (glossy && !reflects(c)) return;
  bsdf::Lobe* lobe = add_lobe(result, glossy ? bsdf::LobeType::GlossyToon : bsdf::LobeType::DiffuseToon,
                              glossy ? bsdf::LightPass::Glossy : bsdf::LightPass::Diffuse,
                              args.weight * non_negative(args.v(0)), diffuse_normal(c, args.v(3)));
  if (!lobe) return;
  lobe->alpha_x = std::clamp(args.f(1), 1e-5f, 1.0f) * (0.5f * kPi);
  lobe->alpha_y = saturate(args.f(2)) * (0.5f * kPi);
}

}  // namespace

bool is_diffuse_below(uint32_t mode, const RayState& ray) {
  const bool is_disk = subsurface_method(mode) == bsdf::SubsurfaceMethod::Disk;
  return (is_disk || (mode & GRADUS_SUBSURFACE_ONCE)) && (ray.flags & kRayDiffuseAncestor);
}

void add_subsurface(const Subsurface& s, ShadeResult* result, const ShadeContext& c) {
  const bsdf::SubsurfaceMethod method = subsurface_method(s.mode);
  Rgb diffuse = s.weight;
  for (int i = 0; i < 3; i++) {
    if (s.radius[i] >= kSmallestRadius && !is_diffuse_below(s.mode, c.ray)) diffuse[i] = 0.0f;
  }
  const bsdf::FresnelType fresnel = s.disney ? bsdf::FresnelType::Schlick : bsdf::FresnelType::None;
  if (bsdf::Lobe* lobe = add_lobe(result, bsdf::LobeType::Diffuse, bsdf::LightPass::Diffuse, diffuse, s.normal)) {
    lobe->fresnel = fresnel;
  }
  bsdf::Lobe* lobe =
      add_lobe(result, bsdf::LobeType::Subsurface, bsdf::LightPass::Diffuse, s.weight - diffuse, s.normal);
  if (!lobe) return;
  lobe->fresnel = fresnel;
  lobe->subsurface = method;
  lobe->f0 = s.color;
  lobe->f90 = s.radius;
  lobe->ior = std::clamp(s.ior, 1.01f, 3.8f);
  lobe->alpha_x = s.alpha;
  lobe->alpha_y = std::clamp(s.anisotropy, -0.99f, method == bsdf::SubsurfaceMethod::WalkDeHulst ? 0.99f : 0.9f);
}

void leave_caustics_out(const ShadeContext& c, bsdf::Lobe* glass) {
  if (!reflects(c))
    glass->type = glass->type == bsdf::LobeType::BeckmannGlass ? bsdf::LobeType::BeckmannRefraction
                                                               : bsdf::LobeType::GgxRefraction;
  if (!refracts(c)) glass->transmission_tint = Rgb(0.0f);
}

Vec3 input_normal(const ShadeContext& c, const Vec3& normal) {
  const Vec3 n = safe_normalize(normal);
  return n == Vec3(0.0f) ? c.normal : n;
}

Vec3 reflecting_normal(const ShadeContext& c, const Vec3& normal) {
  const Vec3 n = input_normal(c, normal);
  if (glm::dot(n, c.geometric_normal) >= 0.0f) return n;
  const Vec3 tilted = bsdf::keep_reflection_above(n, c.geometric_normal, c.wo);
  return glm::dot(tilted, c.geometric_normal) < 0.0f ? Vec3(0.0f) : tilted;
}

Vec3 diffuse_normal(const ShadeContext& c, const Vec3& normal) {
  const bool tilts = c.scene != nullptr && c.material < c.scene->materials.size() &&
                     c.scene->materials[c.material]->shading_normals == GRADUS_SHADING_NORMALS_BEFORE_3_6;
  if (tilts) return reflecting_normal(c, normal);
  const Vec3 n = input_normal(c, normal);
  return glm::dot(n, c.geometric_normal) < 0.0f ? Vec3(0.0f) : n;
}

Vec3 turned_tangent(const ShadeContext& c, const Vec3& tangent, const Vec3& normal, float turns) {
  Vec3 t = safe_normalize(tangent);
  if (t == Vec3(0.0f)) t = default_tangent(c);
  return turns != 0.0f ? rotate_around(t, normal, turns * 2.0f * kPi) : t;
}

void add_film(bsdf::Lobe* lobe, float thickness, float ior, bool fitted) {
  if (!has_film(thickness)) return;
  lobe->film = {thickness, std::max(ior, 1e-5f), fitted};
  switch (lobe->fresnel) {
    case bsdf::FresnelType::PrincipledMetal:
      lobe->fresnel = bsdf::FresnelType::FilmMetal;
      return;
    case bsdf::FresnelType::Conductor:
      lobe->fresnel = bsdf::FresnelType::FilmConductor;
      return;
    case bsdf::FresnelType::Dielectric:
      lobe->f0 = Rgb(bsdf::fresnel_f0(lobe->ior));
      [[fallthrough]];
    default:
      lobe->fresnel = bsdf::FresnelType::FilmDielectric;
  }
}

void set_principled_roughness(bsdf::Lobe* lobe, float roughness, float anisotropic) {
  const float alpha = saturate(roughness) * saturate(roughness);
  const float aspect = std::sqrt(1.0f - 0.9f * saturate(anisotropic));
  lobe->alpha_x = alpha / aspect;
  lobe->alpha_y = alpha * aspect;
}

void set_glossy_roughness(bsdf::Lobe* lobe, float roughness, float anisotropy) {
  const float alpha = saturate(roughness) * saturate(roughness), a = std::clamp(anisotropy, -0.99f, 0.99f);
  lobe->alpha_x = a < 0.0f ? alpha / (1.0f + a) : alpha * (1.0f - a);
  lobe->alpha_y = a < 0.0f ? alpha * (1.0f + a) : alpha / (1.0f - a);
}

void add_finite(const Rgb& value, Rgb* sum, ShadeResult* result) {
  if (is_finite(value)) {
    *sum += value;
  } else {
    result->is_faulty = true;
  }
}

bsdf::Lobe* add_lobe(ShadeResult* result, bsdf::LobeType type, bsdf::LightPass pass, const Rgb& weight,
                     const Vec3& normal) {
  if (!(max_component(weight) > kWeightCutoff)) {
    result->is_faulty = result->is_faulty || !is_finite(weight);
    return nullptr;
  }
  if (normal == Vec3(0.0f)) return nullptr;
  bsdf::Lobe* lobe = result->closures.add();
  lobe->type = type;
  lobe->pass = pass;
  lobe->weight = weight;
  lobe->normal = normal;
  return lobe;
}

Rgb layered(const Rgb& weight, const Rgb& albedo) {
  float largest = 0.0f;
  for (int i = 0; i < 3; i++) largest = std::max(largest, safe_divide(albedo[i], weight[i]));
  return weight * saturate(1.0f - largest);
}

void add_closure(const ClosureArgs& args, const ShadeContext& c, ShadeResult* result) {
  switch (args.op) {
    case GRADUS_OP_DIFFUSE:
      return add_diffuse(args, c, result);
    case GRADUS_OP_TRANSLUCENT:
      add_lobe(result, bsdf::LobeType::Translucent, bsdf::LightPass::Diffuse, args.weight * non_negative(args.v(0)),
               pointing_outward(c, reflecting_normal(c, args.v(1))));
      return;
    case GRADUS_OP_GLOSSY:
      return add_glossy(args, c, result);
    case GRADUS_OP_REFRACTION:
      return add_refraction(args, c, result);
    case GRADUS_OP_GLASS:
      return add_glass(args, c, result);
    case GRADUS_OP_SHEEN:
      return add_sheen(args, c, result);
    case GRADUS_OP_TOON:
      return add_toon(args, c, result);
    case GRADUS_OP_METALLIC:
      return add_metallic(args, c, result);
    case GRADUS_OP_SUBSURFACE:
      return add_subsurface_node(args, c, result);
    case GRADUS_OP_PRINCIPLED:
      return add_principled(args, c, result);
    case GRADUS_OP_PRINCIPLED_3:
      return add_principled_3(args, c, result);
    case GRADUS_OP_TRANSPARENT:
      add_finite(args.weight * non_negative(args.v(0)), &result->transparency, result);
      return;
    case GRADUS_OP_RAY_PORTAL:
      return add_portal(args, c, result);
    case GRADUS_OP_HOLDOUT:
      result->holdout += args.weight;
      return;
    case GRADUS_OP_AOV:
      if (result->aovs != nullptr) result->aovs->push_back({args.mode, args.v(0), args.f(1)});
      return;
    case GRADUS_OP_EMISSION:
      add_finite(args.weight * args.v(0) * args.f(1), &result->emission, result);
      return;
    default:
      return;
  }
}

}  // namespace gradus::shading
