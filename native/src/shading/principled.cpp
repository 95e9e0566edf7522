// The Principled BSDF of Blender 4.0 and later. It is a stack of layers; each is scaled by the light that the layers
// above it let through (Blender manual, "Principled BSDF").
#include <optional>

#include "shading/closure_ops.h"
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

float f0_of_ior(float ior) {
  const float root = (ior - 1.0f) / (ior + 1.0f);
  return root * root;
}

float ior_of_f0(float f0) {
  const float root = std::sqrt(std::clamp(f0, 0.0f, 0.99f));
  return (1.0f + root) / (1.0f - root);
}

// Mode: the thin film is that of Blender before 5.0, which metals do not have.
constexpr uint32_t kLegacyFilm = 32;
// Mode: a coat loses what single scattering loses, as in Blender before 4.5.
constexpr uint32_t kSingleCoat = 64;

// Adds the layers from top to bottom. weight_ is the weight of the layers that are still to come.
class Layers {
  // Inputs of the node in their order.
  enum Input {
    kBaseColor,
    kMetallic,
    kRoughness,
    kIor,
    kDiffuseRoughness,
    kSpecularLevel,
    kSpecularTint,
    kAnisotropic,
    kAnisotropicRotation,
    kTransmission,
    kCoatWeight,
    kCoatRoughness,
    kCoatIor,
    kCoatTint,
    kSheenWeight,
    kSheenRoughness,
    kSheenTint,
    kEmission,
    kNormal,
    kCoatNormal,
    kTangent,
    kSubsurfaceWeight,
    kSubsurfaceRadius,
    kSubsurfaceScale,
    kSubsurfaceIor,
    kSubsurfaceAnisotropy,
    kFilmThickness,
    kFilmIor,
  };

 public:
  Layers(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result)
      : args_(args),
        c_(context),
        result_(result),
        weight_(args.weight),
        normal_(reflecting_normal(context, args.v(kNormal))) {}

  void add() {
    sheen();
    coat();
    add_finite(weight_ * args_.v(kEmission), &result_->emission, result_);
    if (args_.mode & kEmissionOnly) return;
    metal();
    glass();
    specular();
    subsurface();
    diffuse();
  }

 private:
  bool multiscatter() const { return (args_.mode & GRADUS_DISTRIBUTION_MULTIPLE) != 0; }

  // Returns a new lobe of the result, which the caller fills in place, because copying a lobe that was just written
  // stalls the processor. If only the emission is needed it is a temporary lobe.
  bsdf::Lobe* new_layer(bsdf::LobeType type, bsdf::LightPass pass, const Rgb& weight, const Vec3& normal) {
    bsdf::Lobe* lobe = args_.mode & kEmissionOnly ? &spare_.emplace() : result_->closures.add();
    lobe->type = type;
    lobe->pass = pass;
    lobe->weight = normal == Vec3(0.0f) ? Rgb(0.0f) : weight;
    lobe->normal = normal;
    return lobe;
  }

  // Reduces the weight of the layers below by the albedo of this lobe.
  void put_layer(bsdf::Lobe* lobe) { weight_ = layered(weight_, bsdf::lobe_albedo(lobe, c_.wo, c_.geometric_normal)); }

  void sheen() {
    const float amount = std::max(args_.f(kSheenWeight), 0.0f);
    const Rgb tinted = weight_ * amount * glm::max(args_.v(kSheenTint), Vec3(0.0f));
    if (!(max_component(tinted) > kWeightCutoff)) return;
    const Vec3 base_normal = input_normal(c_, args_.v(kNormal)), coat_normal = input_normal(c_, args_.v(kCoatNormal));
    const Vec3 normal = diffuse_normal(c_, glm::mix(base_normal, coat_normal, saturate(args_.f(kCoatWeight))));
    bsdf::Lobe* lobe = new_layer(bsdf::LobeType::Sheen, bsdf::LightPass::Diffuse, tinted, normal);
    lobe->alpha_x = saturate(args_.f(kSheenRoughness));
    put_layer(lobe);
  }

  void coat() {
    const float amount = std::max(args_.f(kCoatWeight), 0.0f);
    if (!(amount * max_component(weight_) > kWeightCutoff)) return;
    const Vec3 normal = reflecting_normal(c_, args_.v(kCoatNormal));
    const float ior = std::max(args_.f(kCoatIor), 1.0f);
    if (reflects(c_)) {
      bsdf::Lobe* lobe = new_layer(bsdf::LobeType::GgxReflection, bsdf::LightPass::Glossy, weight_ * amount, normal);
      lobe->fresnel = bsdf::FresnelType::Dielectric;
      lobe->multiscatter = !(args_.mode & kSingleCoat);  // whatever the distribution of the layers below
      lobe->ior = ior;
      const float roughness = saturate(args_.f(kCoatRoughness));
      lobe->alpha_x = lobe->alpha_y = roughness * roughness;
      put_layer(lobe);
    }
    tint_below_coat(normal, ior, saturate(amount));
  }

  // Applies the coat's tint by Beer's law. The tint is the transmittance of a perpendicular path; the actual path
  // inside the coat is longer by 1/cos.
  void tint_below_coat(const Vec3& normal, float ior, float amount) {
    const Vec3 tint = glm::max(args_.v(kCoatTint), Vec3(0.0f));
    if (tint == Vec3(1.0f)) return;
    const float cosine = glm::dot(c_.wo, normal);
    const float inside = std::sqrt(std::max(1.0f - (1.0f - cosine * cosine) / (ior * ior), 1e-6f));
    const Vec3 kept = glm::pow(tint, Vec3(1.0f / inside));
    weight_ *= glm::mix(Vec3(1.0f), kept, amount);
  }

  void metal() {
    const float metallic = saturate(args_.f(kMetallic));
    const Rgb weight = reflects(c_) ? weight_ * metallic : Rgb(0.0f);
    if (bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::GgxReflection, bsdf::LightPass::Glossy, weight, normal_)) {
      lobe->fresnel = bsdf::FresnelType::PrincipledMetal;
      lobe->f0 = clamped_base();
      lobe->f90 = glm::clamp(args_.v(kSpecularTint), 0.0f, 1.0f);
      set_shape(lobe);
      if (!(args_.mode & kLegacyFilm)) put_film(lobe);
    }
    weight_ *= 1.0f - metallic;
  }

  void glass() {
    const float transmission = saturate(args_.f(kTransmission));
    const Vec3 outward = pointing_outward(c_, normal_);
    const Rgb weight = reflects(c_) || refracts(c_) ? weight_ * transmission : Rgb(0.0f);
    if (bsdf::Lobe* lobe =
            add_lobe(result_, bsdf::LobeType::GgxGlass, bsdf::LightPass::Transmission, weight, outward)) {
      lobe->fresnel = bsdf::FresnelType::Schlick;
      lobe->ior = std::max(args_.f(kIor), 1e-5f);
      lobe->f0 = f0_of_ior(lobe->ior) * glm::max(args_.v(kSpecularTint), Vec3(0.0f));
      lobe->transmission_tint = glm::sqrt(clamped_base());
      const float roughness = saturate(args_.f(kRoughness));
      lobe->alpha_x = lobe->alpha_y = roughness * roughness;
      lobe->multiscatter = multiscatter();
      put_film(lobe);
      leave_caustics_out(c_, lobe);
    }
    weight_ *= 1.0f - transmission;
  }

  // The interface to the layers below, whose IOR the specular level adjusts.
  struct Interface {
    float ior, f0;
  };
  Interface adjusted_interface() const {
    const float ior = std::max(args_.f(kIor), 1e-5f), f0 = f0_of_ior(ior);
    const float level = std::max(args_.f(kSpecularLevel), 0.0f);
    if (level == 0.5f) return {ior, f0};
    const float adjusted = ior_of_f0(f0 * 2.0f * level);
    return {ior < 1.0f ? 1.0f / adjusted : adjusted, f0 * 2.0f * level};
  }

  void specular() {
    const auto [ior, f0] = adjusted_interface();
    if ((ior == 1.0f && !has_film(args_.f(kFilmThickness))) || !(max_component(weight_) > kWeightCutoff) ||
        !reflects(c_))
      return;
    bsdf::Lobe* lobe = new_layer(bsdf::LobeType::GgxReflection, bsdf::LightPass::Glossy, weight_, normal_);
    lobe->fresnel = bsdf::FresnelType::Schlick;
    lobe->ior = ior;
    lobe->f0 = f0 * glm::max(args_.v(kSpecularTint), Vec3(0.0f));
    set_shape(lobe);
    put_film(lobe);
    put_layer(lobe);
  }

  void subsurface() {
    const float amount = saturate(args_.f(kSubsurfaceWeight));
    if (!(amount > kWeightCutoff)) return;
    Subsurface s;
    s.mode = args_.mode;
    s.color = clamped_base();
    s.weight = weight_ * s.color * amount;
    s.radius = args_.v(kSubsurfaceRadius) * args_.f(kSubsurfaceScale);
    const bool has_own_ior = subsurface_method(args_.mode) == bsdf::SubsurfaceMethod::WalkSkin;
    s.ior = has_own_ior ? args_.f(kSubsurfaceIor) : adjusted_interface().ior;
    const float roughness = saturate(args_.f(kRoughness));
    s.alpha = roughness * roughness;
    s.anisotropy = args_.f(kSubsurfaceAnisotropy);
    s.normal = normal_;
    add_subsurface(s, result_, c_);
    weight_ *= 1.0f - amount;
  }

  void diffuse() {
    const Rgb color = glm::max(args_.v(kBaseColor), Vec3(0.0f));
    if (bsdf::Lobe* lobe = add_lobe(result_, bsdf::LobeType::Diffuse, bsdf::LightPass::Diffuse, weight_ * color,
                                    diffuse_normal(c_, args_.v(kNormal)))) {
      lobe->alpha_x = saturate(args_.f(kDiffuseRoughness));
      lobe->multiscatter = true;
      lobe->f0 = color;
    }
  }

  void put_film(bsdf::Lobe* lobe) {
    add_film(lobe, args_.f(kFilmThickness), args_.f(kFilmIor), (args_.mode & kLegacyFilm) != 0);
  }

  void set_shape(bsdf::Lobe* lobe) {
    set_principled_roughness(lobe, args_.f(kRoughness), args_.f(kAnisotropic));
    if (args_.f(kAnisotropic) > 0.0f)
      lobe->tangent = turned_tangent(c_, args_.v(kTangent), normal_, args_.f(kAnisotropicRotation));
    lobe->multiscatter = multiscatter();
  }

  Rgb clamped_base() const { return glm::clamp(args_.v(kBaseColor), 0.0f, 1.0f); }

  const ClosureArgs& args_;
  const ShadeContext& c_;
  ShadeResult* result_;
  std::optional<bsdf::Lobe> spare_;
  Rgb weight_;
  Vec3 normal_;  // of all lobes that are not diffuse
};

}  // namespace

void add_principled(const ClosureArgs& args, const ShadeContext& context, ShadeResult* result) {
  Layers(args, context, result).add();
}

}  // namespace gradus::shading
