// The scattering function of one surface point: a small set of weighted lobes, grouped into classes.
//
// Scattering first samples a class, with probability class_probability(c), then a direction within it; a light sample
// is split over the classes (contract 1.4). All directions point away from the surface; `wo` towards the previous
// vertex, `wi` towards the next.
#pragma once

#include <array>
#include <cstdint>

#include "base/types.h"

namespace gradus::bsdf {

// Letters of a path word (contract 3.1): D rough, R specular reflection, T specular transmission.
enum class ScatterClass : uint8_t { Diffuse = 0, Reflection = 1, Transmission = 2 };
inline constexpr int kScatterClasses = 3;

// What Blender's light passes call a lobe; independent of the class.
enum class LightPass : uint8_t { Diffuse = 0, Glossy = 1, Transmission = 2 };

enum class LobeType : uint8_t {
  Diffuse,  // Lambert, or Oren-Nayar with roughness > 0
  Translucent,
  Sheen,
  GgxReflection,
  GgxRefraction,
  GgxGlass,         // reflection and refraction of one dielectric interface, chosen by Fresnel
  DiracReflection,  // roughness 0
  DiracRefraction,
  DiracGlass,
  Count
};

enum class FresnelType : uint8_t { None, Dielectric, Schlick, PrincipledMetal };

// What single scattering reflects of light from one direction, without weight.
struct KnownAlbedo {
  float cosine = -1.0f;  // under which it is seen; -1: not known
  float ior = 1.0f;
  Rgb reflected = Rgb(0.0f);
};

// One lobe. Frame: normal, and tangent where anisotropic.
//
// Which fields count:
//   Diffuse                alpha_x = Oren-Nayar roughness, 0 = Lambert; multiscatter: energy conserving, f0 = the
//   surface's colour (which
//                          weight holds, too); fresnel Schlick: Disney's diffuse, alpha_x = roughness
//   Sheen                  alpha_x = sheen roughness, not squared; fresnel Schlick: the grazing term of Blender
//   before 4.0 Ggx…, Dirac…           alpha_x, alpha_y, ior, fresnel; finish() makes a Ggx lobe Dirac where alpha is
//   too small for float fresnel Dielectric     of ior fresnel Schlick        mix(f0, f90, s): s follows the dielectric
//   curve of ior, scaled to 0…1, as in Blender 4; ior 1: fifth power fresnel PrincipledMetal  f0, and f90 = tint at 82
//   degrees (1 = plain Schlick)
// multiscatter: the colour of repeated bounces between facets comes from the Fresnel term; without one from f0, a
// colour that weight holds, too (Cycles' MULTI_GGX). Glass reflects with weight·F and transmits with
// weight·transmission_tint·(1 − F).
struct Lobe {
  LobeType type = LobeType::Diffuse;
  FresnelType fresnel = FresnelType::None;
  LightPass pass = LightPass::Diffuse;
  bool multiscatter = false;     // energy lost by single scattering is given back
  Rgb weight = Rgb(0.0f);        // throughput of the node graph times colour
  Vec3 normal = Vec3(0, 0, 1);   // outwards, never flipped towards wo: finish() does that, and inverts ior with it
  Vec3 tangent = Vec3(1, 0, 0);  // made orthonormal by finish(); free where isotropic
  float alpha_x = 0.0f;          // roughness², after anisotropy; diffuse: Oren-Nayar sigma
  float alpha_y = 0.0f;
  float ior = 1.0f;    // of the inside against the outside; after finish(): of the far side against that of wo
  Rgb f0 = Rgb(1.0f);  // Schlick
  Rgb f90 = Rgb(1.0f);
  Rgb transmission_tint = Rgb(1.0f);  // glass lobes
  float sample_weight = 0.0f;         // filled by Closures::finish()
  Rgb energy = Rgb(1.0f);             // multiple scattering, filled by finish()
  KnownAlbedo known;                  // what lobe_albedo() found: finish() mostly asks for the same
  ScatterClass scatter_class =
      ScatterClass::Diffuse;  // reflection side; for GgxGlass the transmission side is T, unless rough (D)
};

// f·|cos(wi)| and its density in solid angle.
struct BsdfEval {
  Rgb value = Rgb(0.0f);
  float pdf = 0.0f;  // p(wi | class)
};

// The whole class, and of it the lobes that make the same kind of bounce (diffuse or not): what limits on bounces,
// visibility to kinds of rays, and the Light Path node look at.
struct KindEval {
  BsdfEval all, kind;
};

struct BsdfSample {
  Vec3 wi = Vec3(0.0f);
  Rgb value = Rgb(0.0f);  // f·|cos|, of the whole class for smooth lobes; for Dirac the coefficient
  float pdf = 0.0f;       // p(wi | class); for Dirac the discrete probability within the class
  bool dirac = false;
  bool transmitted = false;  // wi on the other side of the geometric surface
  uint8_t lobe = 0;          // index of the sampled lobe
  bool diffuse = false;      // kind of the sampled lobe
  BsdfEval kind;             // value and density of the class's lobes of this kind; for Dirac value and pdf again
};

// Directional albedo of one lobe by itself, weight included, before finish(): for layering, so without what single
// scattering loses. wo is inside where normal·wo < 0. All that the lobe looks like must be set; its `known` is filled.
Rgb lobe_albedo(Lobe* lobe, const Vec3& wo);

inline constexpr int kMaxLobes = 12;

class Closures {
 public:
  // Building: add lobes, then finish() once. Where there are kMaxLobes already, the two most alike become one.
  void clear() { count_ = prepared_ = 0; }
  Lobe* add();
  // wo and geometric_normal in world space, geometric_normal on the side of wo. Sorts lobes into classes by
  // roughness_threshold (alpha), drops black ones, fills sampling weights. Can be called again for another wo (a
  // shifted path), and must be: all that follows takes the wo of the last finish(). smooth_normal: interpolated, on the
  // side of wo, without bumps; diffuse lobes with another normal darken softly where it turns away. 0: none.
  void finish(const Vec3& wo, const Vec3& geometric_normal, float roughness_threshold,
              const Vec3& smooth_normal = Vec3(0.0f));

  int count() const { return count_; }
  const Lobe& lobe(int i) const { return lobes_[i]; }
  bool empty() const { return count_ == 0; }

  // Value, density and class probabilities are the same for every wo on one side: all lobes are Lambert's.
  bool ignores_wo() const { return ignores_wo_; }

  // P(class); the probabilities of the classes that are present sum to one. 0: class absent.
  float class_probability(ScatterClass c) const { return class_probability_[static_cast<int>(c)]; }
  // The class has lobes that are not Dirac, so that evaluate() can be non-zero.
  bool has_smooth(ScatterClass c) const { return has_smooth_[static_cast<int>(c)]; }

  // Dirac lobes of the class.
  int dirac_count(ScatterClass c) const { return dirac_count_[static_cast<int>(c)]; }

  // Any class has.
  bool has_smooth() const { return has_smooth_[0] || has_smooth_[1] || has_smooth_[2]; }

  // All smooth lobes of one class together.
  BsdfEval evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi) const;
  // The same, and apart the lobes that make diffuse bounces, or those that do not.
  KindEval evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi, bool diffuse) const;
  // The same where the side of wi is not for the geometric normal to say.
  BsdfEval evaluate_side(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const;
  // Its value, split by Blender's light passes (contract 6.5).
  std::array<Rgb, 3> evaluate_by_pass(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const;
  // u: direction; u_lobe: choice of the lobe. False: absorbed.
  bool sample(ScatterClass c, const Vec3& wo, float u_lobe, const Vec2& u, BsdfSample* out) const;
  // One given lobe alone: what a shift needs to replay a Dirac event with the same lobe. False if the lobe cannot do
  // it.
  bool evaluate_dirac(int lobe, const Vec3& wo, bool transmitted, BsdfSample* out) const;

  // Albedo of the lobes of a pass, for colour passes and denoising.
  Rgb albedo(LightPass pass, const Vec3& wo) const;
  Rgb albedo(const Vec3& wo) const;
  // Average normal of the lobes, weighted as sampled; for the denoising normal.
  Vec3 average_normal() const;

 private:
  // One side (or both) of one lobe in one class.
  struct Entry {
    uint8_t lobe = 0;
    uint8_t sides = 0;
    bool dirac = false;
    float probability = 0.0f;  // within the class
  };
  // As given to add(): finish() starts from these each time.
  struct Original {
    LobeType type;
    Vec3 normal;
    float ior;
  };
  void make_room();
  void drop_black_lobes();
  void keep_originals();
  void prepare(int lobe, const Vec3& wo);
  void add_entries(int lobe, const Vec3& wo, float roughness_threshold);
  void add_entry(int lobe, uint8_t sides, ScatterClass c, float weight);
  void normalise();
  bool is_one_lambert() const;
  void finish_lambert();
  // Value and density (times the entry's probability) of one smooth entry; zero where its normal sees wi on the other
  // side.
  BsdfEval evaluate_entry(const Entry& entry, const Vec3& wo, const Vec3& wi, bool transmitted) const;
  template <class Add>
  void for_smooth(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted, Add&& add) const;
  bool crosses(const Vec3& wi) const;

  std::array<Lobe, kMaxLobes> lobes_;
  int count_ = 0;
  int prepared_ = 0;  // lobes whose original is kept
  std::array<Original, kMaxLobes> original_;
  std::array<std::array<Entry, kMaxLobes>, kScatterClasses> entries_;
  std::array<int, kScatterClasses> entry_count_{};
  std::array<float, kScatterClasses> class_probability_{};
  std::array<bool, kScatterClasses> has_smooth_{};
  std::array<int, kScatterClasses> dirac_count_{};
  bool ignores_wo_ = false;
  Vec3 geometric_normal_ = Vec3(0, 0, 1);
  Vec3 smooth_normal_ = Vec3(0.0f);
};

// Returns whether a lobe scatters within a class: glass scatters within transmission and reflection.
bool scatters_within(const Lobe& lobe, ScatterClass c);

// Number of a Dirac lobe among those of its class, and the lobe with that number (-1: there is none): a Dirac event is
// replayed by the lobe of equal rank, which is a one-to-one relation between two vertices.
int dirac_rank(const Closures& closures, ScatterClass c, int lobe);
int dirac_lobe(const Closures& closures, ScatterClass c, int rank);

}  // namespace gradus::bsdf
