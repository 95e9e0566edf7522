// The scattering function of one surface point: a small set of weighted lobes, grouped into classes.
//
// Scattering first samples a class, with probability class_probability(c), then a direction by the density of that
// class. A light sample is split over the classes. All directions are unit vectors that point away from the surface:
// `wo` towards the previous vertex of the path, `wi` towards the next.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/types.h"
#include "gradus/gradus.h"
#include "guide/guiding_field.h"

namespace gradus::bsdf {

// Classes of scattering: rough (D), specular reflection (R) and specular transmission (T), which are the events of
// light path expressions, and light that enters the object. That light leaves it elsewhere by an event D, so that class
// Subsurface is no event of its own (path/subsurface.h).
enum class ScatterClass : uint8_t { Diffuse = 0, Reflection = 1, Transmission = 2, Subsurface = 3 };
inline constexpr int kScatterClasses = 4;
inline constexpr int kPathEvents = 3;  // the classes below this are events of light path expressions

// The light pass of Blender that a lobe contributes to. It does not depend on the class.
enum class LightPass : uint8_t { Diffuse = 0, Glossy = 1, Transmission = 2 };

enum class LobeType : uint8_t {
  Diffuse,  // Lambert, or Oren-Nayar with roughness > 0
  Sheen,
  DiffuseToon,
  Translucent,
  GlossyToon,
  Velvet,
  Subsurface,
  GgxReflection,
  GgxRefraction,
  GgxGlass,  // reflection and refraction of one dielectric interface, chosen by Fresnel
  BeckmannReflection,
  BeckmannRefraction,
  BeckmannGlass,
  AshikhminShirley,
  DiracReflection,  // roughness 0
  DiracRefraction,
  DiracGlass,
  Count
};

// Bit mask of the sides of the surface to which a lobe scatters.
enum : uint8_t { kReflects = 1, kTransmits = 2, kBothSides = 3 };
// The sides of each LobeType, in its order.
inline constexpr auto kSides = [] {
  std::array<uint8_t, static_cast<size_t>(LobeType::Count)> sides;
  sides.fill(kReflects);
  for (const LobeType type :
       {LobeType::Translucent, LobeType::GgxRefraction, LobeType::BeckmannRefraction, LobeType::DiracRefraction})
    sides[static_cast<size_t>(type)] = kTransmits;
  for (const LobeType type : {LobeType::GgxGlass, LobeType::BeckmannGlass, LobeType::DiracGlass})
    sides[static_cast<size_t>(type)] = kBothSides;
  return sides;
}();
constexpr uint8_t sides_of(LobeType type) { return kSides[static_cast<size_t>(type)]; }
constexpr bool is_dirac(LobeType type) { return type >= LobeType::DiracReflection; }
constexpr bool is_microfacet(LobeType type) { return type >= LobeType::GgxReflection; }
// Returns whether a lobe's bumps darken gradually where they face away from the surface.
constexpr bool has_soft_bumps(LobeType type) { return type <= LobeType::DiffuseToon; }

enum class FresnelType : uint8_t {
  None,
  Dielectric,
  Schlick,
  PrincipledMetal,
  Conductor,
  ApproximateConductor,
  FilmDielectric,
  FilmMetal,
  FilmConductor
};

// How light travels below the surface (subsurface.h): the methods of Cycles, in the order of GradusSubsurface. They
// differ in how light enters, and in the medium that stands for an albedo and a radius.
enum class SubsurfaceMethod : uint8_t {
  Disk,             // Burley's profile instead of a walk
  Walk,             // enters through a rough interface
  WalkSkin,         // enters through a fully rough interface and diffusely, half each; the medium is that of skin
  WalkDeHulst,      // enters through a rough interface; the mean free path is the radius
  WalkDiffuse,      // enters diffusely
  WalkDiffuseSkin,  // enters diffusely; the medium is that of skin
};

// The parts of Disney's diffuse lobe. With subsurface scattering, the parts other than retro-reflection are split
// between the points at which light enters and leaves.
enum class DisneyPart : uint8_t { All, RetroReflection, Exit };

// A cached single-scattering albedo of the reflection side of a lobe, without the lobe's weight.
struct KnownAlbedo {
  float cosine = -1.0f;  // cosine of the normal and wo; -1 if nothing is cached
  float ior = 1.0f;
  Rgb reflected = Rgb(0.0f);
};

// A thin film on microfacets.
struct ThinFilm {
  float thickness = 0.0f;  // nm
  float ior = 1.0f;        // IOR over that outside; after finish() over that of the side of wo
  bool fitted = false;     // whether the observer is a fit, as in Blender before 5.0
};

// One lobe. Its frame is the normal and, where it is anisotropic, the tangent.
//
// The types use these fields:
// - Diffuse: alpha_x is the Oren-Nayar roughness; 0 means Lambert. With multiscatter the lobe conserves energy, and f0
//   is the surface's colour, which is also a factor of the weight. With fresnel Schlick it is Disney's diffuse lobe,
//   and alpha_x its roughness.
//   disney selects a part of it.
// - Subsurface: f0 is the albedo, which is also a factor of the weight, and f90 the radius of each channel. alpha_x is
//   the alpha of the interface, ior its IOR, and alpha_y the anisotropy of the phase function. With fresnel Schlick
//   light leaves by the exit part of Disney's diffuse lobe.
// - Sheen: alpha_x is the sheen roughness, not squared. With fresnel Schlick it is the grazing term of Blender before
//   4.0.
// - DiffuseToon, GlossyToon: alpha_x is the angle of the cone of full brightness in radians, and alpha_y that in which
//   it fades.
// - Velvet: alpha_x is the standard deviation of the slopes' cotangent.
// - Ggx, Beckmann and Dirac types: alpha_x, alpha_y, ior and fresnel. finish() turns a lobe into a Dirac lobe if its
//   alpha is too small for floats. Glass reflects with weight·F and transmits with weight·transmission_tint·(1 − F).
// - AshikhminShirley: alpha_x and alpha_y, from which its exponents follow.
//
// The Fresnel types are:
// - Dielectric: the dielectric term of ior.
// - Schlick: mix(f0, f90, s), where s is the dielectric curve of ior scaled to 0…1, as in Blender 4. For an ior of 1, s
//   is Schlick's fifth power.
// - PrincipledMetal: f0, and f90 as the tint at 82 degrees. A tint of 1 gives the plain Schlick term.
// - Conductor: f0 is the refractive index of each channel, and f90 its extinction.
// - FilmDielectric, FilmMetal, FilmConductor: Schlick with an f90 of 1, PrincipledMetal and Conductor below `film`.
//
// With multiscatter the Fresnel term colours the light that bounces between microfacets. A lobe without a Fresnel term
// takes f0 as that colour, which is also a factor of its weight (Cycles' MULTI_GGX). For glass the colour is
// f90·transmission_tint, where f90 is 1 or the colour that is also a factor of the weight.
struct Lobe {
  LobeType type = LobeType::Diffuse;
  FresnelType fresnel = FresnelType::None;
  LightPass pass = LightPass::Diffuse;
  bool separable_masking = false;  // masks both directions of a microfacet independently, as Blender before 4.0
  bool multiscatter = false;       // adds the energy that single scattering loses
  bool blur_conserves = false;     // multiple scattering conserves energy under a blur, too
  SubsurfaceMethod subsurface = SubsurfaceMethod::Disk;
  DisneyPart disney = DisneyPart::All;
  Rgb weight = Rgb(0.0f);        // throughput of the node graph times colour
  Vec3 normal = Vec3(0, 0, 1);   // outward normal; finish() flips it to the side of wo and then inverts ior
  Vec3 tangent = Vec3(1, 0, 0);  // finish() makes it orthonormal; unused if isotropic
  float alpha_x = 0.0f;          // roughness² along the tangent; for Diffuse the Oren-Nayar roughness
  float alpha_y = 0.0f;
  float ior = 1.0f;    // IOR inside over outside; after finish() that of the far side over the side of wo
  Rgb f0 = Rgb(1.0f);  // reflectance at normal incidence
  Rgb f90 = Rgb(1.0f);
  ThinFilm film;
  Rgb transmission_tint = Rgb(1.0f);  // factor of the transmission side of glass
  float sample_weight = 0.0f;         // weight for sampling, set by finish()
  Rgb energy = Rgb(1.0f);             // factor of multiple scattering, set by finish()
  KnownAlbedo known;                  // cache from lobe_albedo() to finish(), which mostly needs the same albedo
  ScatterClass scatter_class =
      ScatterClass::Diffuse;  // class of the reflection side; the transmission side of glass is T unless this is D
};

// A scattering value f·|cos(wi)| with its density in solid angle, p(wi | class).
struct BsdfEval {
  Rgb value = Rgb(0.0f);
  float pdf = 0.0f;
};

// The value of a whole class, and of its lobes that make the same kind of bounce: diffuse or not. Bounce limits, ray
// visibility and the Light Path node depend on that kind.
struct KindEval {
  BsdfEval all, kind;
};

struct BsdfSample {
  Vec3 wi = Vec3(0.0f);
  Rgb value = Rgb(0.0f);  // f·|cos| of the class's smooth lobes together, or the coefficient of a Dirac lobe
  float pdf = 0.0f;       // p(wi | class), or the discrete probability of a Dirac lobe within the class
  bool dirac = false;
  bool transmitted = false;  // whether wi is on the other side of the geometric surface
  uint8_t lobe = 0;          // index of the sampled lobe
  bool diffuse = false;      // whether the sampled lobe makes a diffuse bounce
  BsdfEval kind;             // value and density of the class's lobes of that kind; value and pdf for a Dirac lobe
  // `pdf` and `kind.pdf` if no direction were guided.
  float unguided_pdf = 0.0f, unguided_kind_pdf = 0.0f;
};

// Returns the directional albedo of one lobe before finish(), including its weight, for the layers below it. It ignores
// the energy that single scattering loses. `geometric_normal` is on the side of wo, as for finish(); wo is inside the
// object if the lobe's normal is on the other side. All inputs of the lobe must be set; the function fills
// `lobe->known`.
Rgb lobe_albedo(Lobe* lobe, const Vec3& wo, const Vec3& geometric_normal);

inline constexpr int kMaxLobes = 12;

// Largest probability of the classes that are not specular at which a surface counts as a mirror or clear glass, which
// shows little else than what it reflects and refracts. Up to Blender 4.5 the features of Cycles' denoiser looked
// through the same ones.
inline constexpr float kMaxNonSpecular = 0.25f;

// The lobes of a surface point. A caller adds lobes, calls finish(), and then evaluates and samples.
class Closures {
 public:
  void clear() {
    count_ = prepared_ = 0;
    transmits_ = false;
  }
  // Returns a new lobe. If there are kMaxLobes already, the two most similar lobes are merged first.
  Lobe* add();
  // Sorts the lobes into classes by `roughness_threshold` (an alpha), removes black lobes and sets the sampling
  // weights. `wo` and `geometric_normal` are in world space, the normal on the side of wo. All functions below require
  // the wo of the last finish(); call it again for another wo, as shifted paths do. `smooth_normal` is the interpolated
  // normal without bumps, on the side of wo, or 0 for none. Diffuse lobes with another normal darken gradually where
  // the surface faces away. `blur` is the minimum alpha of microfacet lobes; as in Cycles, the energy of
  // multiple scattering is that without it, except where blur_conserves.
  void finish(const Vec3& wo, const Vec3& geometric_normal, float roughness_threshold,
              const Vec3& smooth_normal = Vec3(0.0f), float blur = 0.0f);

  // Sets the factor of angles in the cosine of reflection, at least 1 (shading_normal.h). finish() does not change it.
  void set_terminator_frequency(float frequency) { terminator_frequency_ = frequency; }
  // Sets how normals are corrected that disagree with the geometric normal: a GradusShadingNormals. finish() does not
  // change it.
  void set_shading_normals(uint32_t version) { shading_normals_ = version; }

  // Lets diffuse lobes of class Diffuse take the guide's share of their directions from what lights the surface at
  // `position`, until the next finish(), for a path that is guided with the given probability. Densities include that
  // share.
  void guide_by(const guide::Guide& guide, const Vec3& position, float probability) {
    guide.places.see_from(position, geometric_normal_, &guide_);
    guided_share_ = guide.share * probability;
  }

  int count() const { return count_; }
  const Lobe& lobe(int i) const { return lobes_[i]; }
  bool empty() const { return count_ == 0; }

  // Returns whether value, density and class probabilities are equal for all wo on one side: all lobes are Lambert.
  bool ignores_wo() const { return ignores_wo_; }

  // Returns the probability of a class, or 0 if it has no lobes. The probabilities sum to 1.
  float class_probability(ScatterClass c) const { return class_probability_[static_cast<int>(c)]; }
  // Returns whether the class has lobes that are not Dirac, so that evaluate() can be non-zero.
  bool has_smooth(ScatterClass c) const { return has_smooth_[static_cast<int>(c)]; }

  // Returns whether a lobe that is not Dirac transmits light.
  bool transmits() const { return transmits_; }

  // Returns the number of Dirac lobes of the class.
  int dirac_count(ScatterClass c) const { return dirac_count_[static_cast<int>(c)]; }

  // Returns whether any class has lobes that are not Dirac.
  bool has_smooth() const { return has_smooth_[0] || has_smooth_[1] || has_smooth_[2]; }

  // Returns the probability of the classes that are not specular.
  float non_specular_probability() const {
    return class_probability(ScatterClass::Diffuse) + class_probability(ScatterClass::Subsurface);
  }
  // Chooses a lobe of class Subsurface by u in [0, 1). Returns its index, and its probability within the class.
  int choose_subsurface(float u, float* probability) const;

  // Returns the density of a direction among all smooth lobes, whatever their class, if no direction were guided.
  float unguided_pdf(const Vec3& wo, const Vec3& wi) const;
  // Returns the density of a direction among the smooth lobes of a class over that without a guide: of those whose
  // bounces are diffuse, or not, as `diffuse` says, or of all.
  float guided_ratio(ScatterClass c, const Vec3& wo, const Vec3& wi, std::optional<bool> diffuse) const;
  // Returns the sum of all smooth lobes of one class.
  BsdfEval evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi) const;
  // Returns that sum, and separately the sum of the lobes whose bounces are diffuse, or not, as `diffuse` says.
  KindEval evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi, bool diffuse) const;
  // Returns the sum of all smooth lobes where the caller, not the geometric normal, decides the side of wi.
  BsdfEval evaluate_side(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const;
  // Returns whether most of what the smooth lobes of a class transmit is glass whose alpha_x·alpha_y is at most
  // `limit`.
  bool transmits_clearly(ScatterClass c, const Vec3& wo, const Vec3& wi, float limit) const;
  // Returns the light pass of one side of a lobe. As in Cycles, the reflection side of glass is glossy.
  LightPass light_pass(int lobe, bool transmitted) const;
  // Returns the value of evaluate_side(), split by Blender's light passes.
  std::array<Rgb, 3> evaluate_by_pass(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const;
  // Samples a direction of the class. `u_lobe` chooses the lobe and `u` the direction; both are uniform in [0, 1).
  // Returns false if the light is absorbed.
  bool sample(ScatterClass c, const Vec3& wo, float u_lobe, const Vec2& u, BsdfSample* out) const;
  // Scatters by one given Dirac lobe, as a shifted path does to replay a Dirac event. Returns false if the lobe does
  // not scatter to that side.
  bool evaluate_dirac(int lobe, const Vec3& wo, bool transmitted, BsdfSample* out) const;

  // Returns the albedo of the lobes of a pass, or of all, for colour passes and denoising.
  Rgb albedo(LightPass pass, const Vec3& wo) const;
  Rgb albedo(const Vec3& wo) const;
  // Returns the average normal of the lobes by their sampling weights, for denoising.
  Vec3 average_normal() const;

 private:
  // One side, or both sides, of one lobe as a member of a class.
  struct Entry {
    uint8_t lobe = 0;
    uint8_t sides = 0;
    bool dirac = false;
    float probability = 0.0f;  // probability within the class
  };
  // The inputs of a lobe that finish() overwrites, so that each call starts from the same values.
  struct Original {
    LobeType type;
    Vec3 normal;
    float ior;
    float film_ior;
    float alpha_x, alpha_y;
  };
  void make_room();
  void drop_black_lobes();
  void keep_originals();
  void prepare(int lobe, const Vec3& wo);
  void add_entries(int lobe, const Vec3& wo, float roughness_threshold);
  void add_entry(int lobe, uint8_t sides, ScatterClass c, float weight);
  void normalise();
  // Returns whether the mirror directions of diffuse lobes, too, are kept above the geometric surface.
  bool tilts_diffuse() const;
  // Returns whether the normal of a diffuse lobe may depend on wo.
  bool is_tilted(int lobe) const;
  bool is_one_lambert() const;
  void finish_lambert();
  // Returns value and density of one smooth entry, the density times the entry's probability. The result is 0 if the
  // lobe's normal sees wi on the other side than `transmitted` says.
  BsdfEval evaluate_entry(const Entry& entry, const Vec3& wo, const Vec3& wi, bool transmitted) const;
  template <class Add>
  void for_smooth(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted, Add&& add) const;
  bool crosses(const Vec3& wi) const;
  // Returns whether the guide chooses a share of the directions of a class.
  bool guides(ScatterClass c) const { return guided_share_ > 0.0f && c == ScatterClass::Diffuse; }

  std::array<Lobe, kMaxLobes> lobes_;
  int count_ = 0;
  int prepared_ = 0;  // number of lobes whose inputs are in original_
  std::array<Original, kMaxLobes> original_;
  std::array<std::array<Entry, kMaxLobes>, kScatterClasses> entries_;
  std::array<int, kScatterClasses> entry_count_{};
  std::array<float, kScatterClasses> class_probability_{};
  std::array<bool, kScatterClasses> has_smooth_{};
  std::array<int, kScatterClasses> dirac_count_{};
  bool ignores_wo_ = false;
  bool transmits_ = false;
  Vec3 geometric_normal_ = Vec3(0, 0, 1);
  Vec3 smooth_normal_ = Vec3(0.0f);
  float terminator_frequency_ = 1.0f;
  uint32_t shading_normals_ = GRADUS_SHADING_NORMALS_SINCE_4_5;
  float blur_ = 0.0f;
  float guided_share_ = 0.0f;
  guide::DirectionMixture guide_;  // set if there is a guided share
};

// Returns whether a lobe scatters within a class. Glass belongs to reflection and transmission.
bool scatters_within(const Lobe& lobe, ScatterClass c);

// dirac_rank() returns the rank of a Dirac lobe among those of its class; dirac_lobe() returns the lobe of a rank, or
// -1 if there is none. A shifted path replays a Dirac event by the lobe of equal rank, so that the lobes of two
// vertices correspond one to one.
int dirac_rank(const Closures& closures, ScatterClass c, int lobe);
int dirac_lobe(const Closures& closures, ScatterClass c, int rank);

}  // namespace gradus::bsdf
