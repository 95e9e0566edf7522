// The Principled BSDF of Blender before 4.0 (after Burley 2012 and 2015). The diffuse colour is also that of subsurface
// scattering.
#include "shading/closure_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Adds the lobes of the BSDF.
class Lobes {
  // Inputs of the node in their order.
  enum Input {
    kBaseColor,
    kDiffuseColor,
    kMetallic,
    kSpecular,
    kSpecularTint,
    kRoughness,
    kAnisotropic,
    kAnisotropicRotation,
    kSheen,
    kSheenTint,
    kClearcoat,
    kClearcoatRoughness,
    kIor,
    kTransmission,
    kTransmissionRoughness,
    kNormal,
    kClearcoatNormal,
    kTangent,
    kSubsurface,
    kSubsurfaceRadius,
    kSubsurfaceIor,
    kSubsurfaceAnisotropy,
  };

 public:
  Lobes(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result)
      : args_(args), c_(context), result_(result), normal_(reflecting_normal(context, args.v(kNormal))) {
    base_ = glm::max(args.v(kBaseColor), Vec3(0.0f));
    subsurface_ = args.f(kSubsurface);
    if (subsurface_ > kWeightCutoff && is_diffuse_below(args.mode, context.ray)) {
      base_ = glm::max(args.v(kDiffuseColor), Vec3(0.0f));
      subsurface_ = 0.0f;
    }
    const float grey = luminance(base_);
    hue_ = grey > 0.0f ? base_ / grey : Rgb(1.0f);
    metallic_ = saturate(args.f(kMetallic));
    transmission_ = saturate(args.f(kTransmission)) * (1.0f - metallic_);
    diffuse_ = (1.0f - metallic_) * (1.0f - saturate(args.f(kTransmission)));
  }

  void add() {
    diffuse();
    sheen();
    specular();
    glass();
    clearcoat();
  }

 private:
  static Rgb tinted(const Rgb& color, float amount) { return Rgb(1.0f - amount) + color * amount; }

  void diffuse() {
    const Rgb color = glm::max(args_.v(kDiffuseColor), Vec3(0.0f));
    const Rgb weight = args_.weight * color * diffuse_;
    bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::Diffuse, bsdf::LightPass::Diffuse, weight, normal_);
    if (!lobe) return;
    lobe->fresnel = bsdf::FresnelType::Schlick;  // Disney's diffuse
    lobe->alpha_x = saturate(args_.f(kRoughness));
    if (!(subsurface_ > kWeightCutoff)) return;
    lobe->disney = bsdf::DisneyPart::RetroReflection;
    subsurface(weight, color);
  }

  void subsurface(const Rgb& weight, const Rgb& color) {
    Subsurface s;
    s.mode = args_.mode;
    s.weight = weight;
    s.color = color;
    s.radius = args_.v(kSubsurfaceRadius) * subsurface_;
    s.ior = args_.f(kSubsurfaceIor);
    s.anisotropy = args_.f(kSubsurfaceAnisotropy);
    s.normal = normal_;
    s.disney = true;
    add_subsurface(s, result_, c_);
  }

  void sheen() {
    const Rgb color = tinted(hue_, saturate(args_.f(kSheenTint)));
    bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::Sheen, bsdf::LightPass::Diffuse,
                                args_.weight * color * (diffuse_ * std::max(args_.f(kSheen), 0.0f)), normal_);
    if (lobe) lobe->fresnel = bsdf::FresnelType::Schlick;
  }

  void specular() {
    const float amount = std::max(args_.f(kSpecular), 0.0f);
    if (!reflects(c_) || (amount <= kWeightCutoff && metallic_ <= kWeightCutoff)) return;
    const Rgb f0 =
        tinted(hue_, saturate(args_.f(kSpecularTint))) * (0.08f * amount * (1.0f - metallic_)) + base_ * metallic_;
    bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::GgxReflection, bsdf::LightPass::Glossy,
                                args_.weight * (1.0f - transmission_), normal_);
    if (!lobe) return;
    set_principled_roughness(lobe, args_.f(kRoughness), args_.f(kAnisotropic));
    if (args_.f(kAnisotropic) > 0.0f)
      lobe->tangent = turned_tangent(c_, args_.v(kTangent), normal_, args_.f(kAnisotropicRotation));
    lobe->multiscatter = args_.mode & GRADUS_DISTRIBUTION_MULTIPLE;
    lobe->separable_masking = !lobe->multiscatter;
    lobe->blur_conserves = lobe->multiscatter;
    lobe->ior = 2.0f / (1.0f - std::sqrt(std::min(0.08f * amount, 0.99f))) - 1.0f;
    lobe->fresnel = bsdf::FresnelType::Schlick;
    lobe->f0 = f0;
    if (lobe->ior == 1.0f) {
      // Without a step in the IOR the Fresnel term is constant.
      lobe->fresnel = bsdf::FresnelType::None;
      lobe->weight *= f0;
    }
  }

  void glass() {
    if (!(transmission_ > kWeightCutoff) || !(reflects(c_) || refracts(c_))) return;
    const float roughness = saturate(args_.f(kRoughness));
    if (roughness <= 0.05f || !(args_.mode & GRADUS_DISTRIBUTION_MULTIPLE))
      single_scattering_glass(roughness);
    else
      multiple_scattering_glass(roughness);
  }

  // Adds glass as two lobes, weighted by the Fresnel term of the shading normal. Their roughness may differ.
  void single_scattering_glass(float roughness) {
    const float ior = std::max(args_.f(kIor), 1e-5f);
    const float reflected = dielectric_reflectance(glm::dot(c_.wo, normal_), c_.backfacing ? 1.0f / ior : ior);
    const Rgb weight = args_.weight * transmission_;
    const Rgb reflection = reflects(c_) ? weight * reflected : Rgb(0.0f);
    const Rgb refraction = refracts(c_) ? weight * base_ * (1.0f - reflected) : Rgb(0.0f);
    if (bsdf::Lobe* lobe =
            add_lobe(result_, bsdf::LobeType::GgxReflection, bsdf::LightPass::Glossy, reflection, normal_)) {
      lobe->alpha_x = lobe->alpha_y = roughness * roughness;
      lobe->separable_masking = true;
      lobe->fresnel = bsdf::FresnelType::Schlick;
      lobe->ior = ior;
      lobe->f0 = tinted(base_, saturate(args_.f(kSpecularTint)));
    }
    const Vec3 outward = pointing_outward(c_, normal_);
    if (bsdf::Lobe* lobe =
            add_lobe(result_, bsdf::LobeType::GgxRefraction, bsdf::LightPass::Transmission, refraction, outward)) {
      float refracted = roughness;
      if (!(args_.mode & GRADUS_DISTRIBUTION_MULTIPLE))
        refracted = 1.0f - (1.0f - roughness) * (1.0f - saturate(args_.f(kTransmissionRoughness)));
      lobe->alpha_x = lobe->alpha_y = refracted * refracted;
      lobe->separable_masking = true;
      lobe->ior = ior;
    }
  }

  void multiple_scattering_glass(float roughness) {
    const Vec3 outward = pointing_outward(c_, normal_);
    bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::GgxGlass, bsdf::LightPass::Transmission,
                                args_.weight * transmission_, outward);
    if (!lobe) return;
    lobe->alpha_x = lobe->alpha_y = roughness * roughness;
    lobe->ior = std::max(args_.f(kIor), 1e-5f);
    lobe->fresnel = bsdf::FresnelType::Dielectric;
    lobe->transmission_tint = base_;
    lobe->multiscatter = true;
    lobe->blur_conserves = true;
  }

  void clearcoat() {
    if (!reflects(c_)) return;
    const float amount = saturate(args_.f(kClearcoat));
    bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::GgxReflection, bsdf::LightPass::Glossy,
                                args_.weight * (0.25f * amount), reflecting_normal(c_, args_.v(kClearcoatNormal)));
    if (!lobe) return;
    const float roughness = saturate(args_.f(kClearcoatRoughness));
    lobe->alpha_x = lobe->alpha_y = roughness * roughness;
    lobe->separable_masking = true;
    lobe->fresnel = bsdf::FresnelType::Schlick;
    lobe->ior = 1.5f;
    lobe->f0 = Rgb(0.04f);
  }

  const ClosureArgs& args_;
  const ShadeContext& c_;
  ShadeResult* result_;
  Vec3 normal_;
  Rgb base_;
  Rgb hue_;
  float subsurface_;  // 0 where it is seen as a diffuse surface
  float metallic_;
  float transmission_;
  float diffuse_;
};

}  // namespace

void add_principled_3(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result) {
  Lobes(args, context, result).add();
}

}  // namespace gradus::shading
