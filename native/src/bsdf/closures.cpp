// Preparation of the closures of a surface point: normals, Dirac limits, classes and their probabilities.
#include "bsdf/closures.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/lobe.h"
#include "bsdf/shading_frame.h"
#include "bsdf/shading_normal.h"

namespace gradus::bsdf {
namespace {

// Minimum share of a lobe's weight with which a side is sampled. A tabulated albedo of 0 may be slightly wrong.
constexpr float kSmallestShare = 0.01f;

// Returns the perfectly smooth counterpart of a microfacet type.
LobeType dirac_of(LobeType type) {
  switch (sides_of(type)) {
    case kReflects:
      return LobeType::DiracReflection;
    case kTransmits:
      return LobeType::DiracRefraction;
    default:
      return LobeType::DiracGlass;
  }
}

// Clamps roughness and IOR to their ranges. A lobe becomes Dirac where floats cannot represent it: if it is too smooth,
// or if it transmits without a step in the IOR.
void limit_microfacets(Lobe* lobe) {
  lobe->ior = std::clamp(is_finite(lobe->ior) ? lobe->ior : 1.0f, 1e-2f, 1e2f);
  lobe->alpha_x = std::clamp(is_finite(lobe->alpha_x) ? lobe->alpha_x : 1.0f, 0.0f, 1.0f);
  lobe->alpha_y = std::clamp(is_finite(lobe->alpha_y) ? lobe->alpha_y : 1.0f, 0.0f, 1.0f);
  const bool stepless = std::abs(lobe->ior - 1.0f) < kSmallestIorStep;
  if (stepless && sides_of(lobe->type) & kTransmits) {
    lobe->ior = 1.0f;
  }
  if (is_dirac(lobe->type) || lobe->alpha_x * lobe->alpha_y < kSmallestAlpha * kSmallestAlpha ||
      (stepless && sides_of(lobe->type) & kTransmits)) {
    lobe->type = dirac_of(lobe->type);
    lobe->alpha_x = lobe->alpha_y = 0.0f;
  } else {
    lobe->alpha_x = std::max(lobe->alpha_x, kSmallestAlpha);
    lobe->alpha_y = std::max(lobe->alpha_y, kSmallestAlpha);
  }
}

// Raises the alphas of a prepared microfacet lobe to `blur`; `rough` is its type before it was prepared. Without a step
// in the IOR nothing bends light, so that a lobe that transmits stays as it is.
void blur_lobe(float blur, LobeType rough, const Vec3& wo, Lobe* lobe) {
  const bool stepless = lobe->ior == 1.0f && sides_of(lobe->type) & kTransmits;
  if (!is_microfacet(lobe->type) || stepless) {
    return;
  }
  lobe->type = rough;
  lobe->alpha_x = std::max(lobe->alpha_x, blur);
  lobe->alpha_y = std::max(lobe->alpha_y, blur);
  if (lobe->blur_conserves) {
    lobe->energy = multiscatter_energy(*lobe, glm::dot(lobe->normal, wo));
  }
}

// Returns the smaller alpha of a lobe, which is compared with the roughness threshold.
float sharpness(const Lobe& lobe) { return is_microfacet(lobe.type) ? std::min(lobe.alpha_x, lobe.alpha_y) : 1.0f; }

}  // namespace

Lobe* Closures::add() {
  if (count_ == kMaxLobes) {
    make_room();
  }
  Lobe* lobe = &lobes_[static_cast<size_t>(count_++)];
  std::construct_at(lobe);
  return lobe;
}

void Closures::make_room() {
  drop_black_lobes();
  if (count_ < kMaxLobes) {
    return;
  }
  size_t first = 0, second = 1;
  float minimum = kInfinity;
  for (size_t i = 0; i < lobes_.size(); i++) {
    for (size_t j = i + 1; j < lobes_.size(); j++) {
      const float cost = merge_cost(lobes_[i], lobes_[j]);
      if (cost < minimum) {
        minimum = cost;
        first = i;
        second = j;
      }
    }
  }
  lobes_[first] = merged(lobes_[first], lobes_[second]);
  lobes_[second] = lobes_[static_cast<size_t>(--count_)];
}

void Closures::drop_black_lobes() {
  int kept = prepared_;
  for (int i = prepared_; i < count_; i++) {
    Lobe& lobe = lobes_[static_cast<size_t>(i)];
    lobe.weight = glm::max(lobe.weight, 0.0f);
    if (is_finite(lobe.weight) && !is_black(lobe.weight)) {
      if (kept != i) {
        lobes_[static_cast<size_t>(kept)] = lobe;
      }
      kept++;
    }
  }
  count_ = kept;
}

void Closures::keep_originals() {
  for (; prepared_ < count_; prepared_++) {
    const Lobe& lobe = lobes_[static_cast<size_t>(prepared_)];
    original_[static_cast<size_t>(prepared_)] = {lobe.type,     lobe.normal,  lobe.ior,
                                                 lobe.film.ior, lobe.alpha_x, lobe.alpha_y};
  }
}

namespace {

// Returns the normalised `normal`, or the geometric normal if it has no direction. A normal of unit length is returned
// unchanged to the bit, because equality with the smooth normal tells that no bump needs shadowing.
Vec3 unit_normal(const Vec3& normal, const Vec3& geometric_normal) {
  const float length2 = glm::dot(normal, normal);
  if (std::abs(length2 - 1.0f) < 1e-6f) {
    return normal;
  }
  return is_finite(length2) && length2 > 1e-12f ? normal / std::sqrt(length2) : geometric_normal;
}

// Returns unit_normal() on the side of the geometric normal.
Vec3 outward_unit_normal(const Vec3& normal, const Vec3& geometric_normal) {
  const Vec3 unit = unit_normal(normal, geometric_normal);
  return glm::dot(unit, geometric_normal) < 0.0f ? -unit : unit;
}

}  // namespace

void prepare_lobe(Lobe* lobe, const Vec3& geometric_normal, const Vec3& wo, bool tilts_diffuse) {
  Vec3 normal = unit_normal(lobe->normal, geometric_normal);
  const bool inside = glm::dot(normal, geometric_normal) < 0.0f;
  if (inside) {
    normal = -normal;
  }
  if (is_microfacet(lobe->type)) {
    limit_microfacets(lobe);
    if (inside) {
      lobe->ior = 1.0f / lobe->ior;
      lobe->film.ior *= lobe->ior;
    }
  }
  if (tilts_diffuse || is_microfacet(lobe->type) || lobe->type == LobeType::Subsurface) {
    normal = keep_reflection_above(normal, geometric_normal, wo);
  }
  lobe->normal = normal;
  lobe->tangent = lobe->alpha_x == lobe->alpha_y ? perpendicular(normal) : orthonormal_tangent(normal, lobe->tangent);
  lobe->energy = multiscatter_energy(*lobe, glm::dot(normal, wo));
}

void Closures::prepare(int index, const Vec3& wo) {
  Lobe& lobe = lobes_[static_cast<size_t>(index)];
  const Original& original = original_[static_cast<size_t>(index)];
  lobe.type = original.type;
  lobe.normal = original.normal;
  lobe.ior = original.ior;
  lobe.film.ior = original.film_ior;
  lobe.alpha_x = original.alpha_x;
  lobe.alpha_y = original.alpha_y;
  prepare_lobe(&lobe, geometric_normal_, wo, tilts_diffuse());
  if (blur_ > 0.0f) {
    blur_lobe(blur_, original.type, wo, &lobe);
  }
}

void Closures::add_entry(int lobe, uint8_t sides, ScatterClass c, float weight) {
  if (!(weight > 0.0f) || !is_finite(weight)) {
    return;
  }
  const size_t k = static_cast<size_t>(c);
  const bool dirac = is_dirac(lobes_[static_cast<size_t>(lobe)].type);
  has_smooth_[k] = has_smooth_[k] || (!dirac && c != ScatterClass::Subsurface);
  entries_[k][static_cast<size_t>(entry_count_[k]++)] = {static_cast<uint8_t>(lobe), sides, dirac, weight};
}

void Closures::add_entries(int index, const Vec3& wo, float roughness_threshold) {
  Lobe& lobe = lobes_[static_cast<size_t>(index)];
  if (lobe.type == LobeType::Diffuse && lobe.disney != DisneyPart::RetroReflection) {
    // A fast path for the most common lobe. The results are those of the general code.
    lobe.sample_weight = mean_component(lobe.weight);
    lobe.scatter_class = ScatterClass::Diffuse;
    add_entry(index, kReflects, ScatterClass::Diffuse, lobe.sample_weight);
    return;
  }
  const LobeAlbedo albedo = two_sided_albedo(lobe, glm::dot(lobe.normal, wo));
  float reflected = mean_component(albedo.reflected);
  float transmitted = mean_component(albedo.transmitted);
  const uint8_t sides = sides_of(lobe.type);
  transmits_ = transmits_ || (!is_dirac(lobe.type) && (sides & kTransmits) != 0);
  const float minimum = is_dirac(lobe.type) ? 0.0f : kSmallestShare * mean_component(lobe.weight);
  reflected = sides & kReflects ? std::max(reflected, minimum) : 0.0f;
  transmitted = sides & kTransmits ? std::max(transmitted, minimum) : 0.0f;
  if (lobe.disney == DisneyPart::RetroReflection) {
    reflected *=
        std::max(kSmallestShare, lobe.alpha_x * pow5(std::clamp(1.0f - glm::dot(lobe.normal, wo), 0.0f, 1.0f)));
  }
  lobe.sample_weight = reflected + transmitted;
  if (lobe.type == LobeType::Subsurface) {
    lobe.scatter_class = ScatterClass::Subsurface;
    add_entry(index, kReflects, ScatterClass::Subsurface, lobe.sample_weight);
    return;
  }
  if (is_dirac(lobe.type)) {
    dirac_count_[static_cast<size_t>(ScatterClass::Reflection)] += (sides & kReflects) != 0;
    dirac_count_[static_cast<size_t>(ScatterClass::Transmission)] += (sides & kTransmits) != 0;
  }
  const bool rough = !is_dirac(lobe.type) && sharpness(lobe) >= roughness_threshold;
  if (!is_microfacet(lobe.type) || rough) {
    lobe.scatter_class = ScatterClass::Diffuse;
    add_entry(index, sides, ScatterClass::Diffuse, lobe.sample_weight);
    return;
  }
  lobe.scatter_class = sides & kReflects ? ScatterClass::Reflection : ScatterClass::Transmission;
  add_entry(index, kReflects, ScatterClass::Reflection, reflected);
  add_entry(index, kTransmits, ScatterClass::Transmission, transmitted);
}

void Closures::normalise() {
  float sum = 0.0f;
  for (int c = 0; c < kScatterClasses; c++) {
    const size_t k = static_cast<size_t>(c);
    float total = 0.0f;
    for (int i = 0; i < entry_count_[k]; i++) {
      total += entries_[k][static_cast<size_t>(i)].probability;
    }
    for (int i = 0; i < entry_count_[k]; i++) {
      entries_[k][static_cast<size_t>(i)].probability /= total;
    }
    class_probability_[k] = total;
    sum += total;
  }
  for (float& p : class_probability_) {
    p = sum > 0.0f ? p / sum : 0.0f;
  }
}

bool Closures::tilts_diffuse() const { return shading_normals_ == GRADUS_SHADING_NORMALS_BEFORE_3_6; }

bool Closures::is_tilted(int lobe) const {
  const Vec3& normal = original_[static_cast<size_t>(lobe)].normal;
  return tilts_diffuse() && normal != geometric_normal_ && normal != -geometric_normal_;
}

bool Closures::is_one_lambert() const { return count_ == 1 && is_lambert(lobes_[0]); }

// A fast path for a single Lambert lobe, the most common surface. The results are those of the general code.
void Closures::finish_lambert() {
  Lobe& lobe = lobes_[0];
  lobe.normal = outward_unit_normal(original_[0].normal, geometric_normal_);
  lobe.tangent = perpendicular(lobe.normal);
  lobe.energy = Rgb(1.0f);
  lobe.sample_weight = mean_component(lobe.weight);
  lobe.scatter_class = ScatterClass::Diffuse;
  const bool scatters = is_finite(lobe.sample_weight);  // drop_black_lobes() has ensured that it is not 0
  constexpr size_t k = static_cast<size_t>(ScatterClass::Diffuse);
  has_smooth_[k] = scatters;
  entry_count_[k] = scatters ? 1 : 0;
  entries_[k][0] = {0, kReflects, false, 1.0f};
  class_probability_.fill(0.0f);
  class_probability_[k] = scatters ? 1.0f : 0.0f;
}

void Closures::finish(const Vec3& wo, const Vec3& geometric_normal, float roughness_threshold,
                      const Vec3& smooth_normal, float blur) {
  geometric_normal_ = geometric_normal;
  smooth_normal_ = smooth_normal;
  blur_ = blur;
  guided_share_ = 0.0f;
  entry_count_.fill(0);
  dirac_count_.fill(0);
  has_smooth_.fill(false);
  drop_black_lobes();
  keep_originals();
  ignores_wo_ = true;
  transmits_ = false;
  if (is_one_lambert() && !tilts_diffuse()) {
    finish_lambert();
    return;
  }
  for (int i = 0; i < count_; i++) {
    prepare(i, wo);
    add_entries(i, wo, roughness_threshold);
    ignores_wo_ = ignores_wo_ && is_lambert(lobes_[static_cast<size_t>(i)]) && !is_tilted(i);
  }
  normalise();
}

Vec3 Closures::average_normal() const {
  Vec3 sum(0.0f);
  for (int i = 0; i < count_; i++) {
    sum += lobe(i).normal * lobe(i).sample_weight;
  }
  const float length2 = glm::dot(sum, sum);
  return length2 > 0.0f ? sum / std::sqrt(length2) : geometric_normal_;
}

}  // namespace gradus::bsdf
