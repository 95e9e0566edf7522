// Evaluation and sampling of finished closures.
#include <algorithm>
#include <array>
#include <cmath>

#include "bsdf/beckmann.h"
#include "bsdf/closures.h"
#include "bsdf/ggx.h"
#include "bsdf/lobe.h"
#include "bsdf/microfacets.h"
#include "bsdf/shading_frame.h"
#include "bsdf/shading_normal.h"

namespace gradus::bsdf {
namespace {

struct LobeFunctions {
  EvaluateLobe evaluate;
  SampleLobe sample;
};
// The functions of each LobeType, in its order. Dirac lobes and subsurface scattering have none.
constexpr std::array<LobeFunctions, static_cast<size_t>(LobeType::Count)> kFunctions = {{
    {evaluate_diffuse, sample_diffuse},
    {evaluate_sheen, sample_sheen},
    {evaluate_toon, sample_toon},
    {evaluate_translucent, sample_translucent},
    {evaluate_toon, sample_toon},
    {evaluate_velvet, sample_velvet},
    {nullptr, nullptr},
    {evaluate_reflection<Ggx>, sample_reflection<Ggx>},
    {evaluate_refraction<Ggx>, sample_refraction<Ggx>},
    {evaluate_glass<Ggx>, sample_glass<Ggx>},
    {evaluate_reflection<Beckmann>, sample_reflection<Beckmann>},
    {evaluate_refraction<Beckmann>, sample_refraction<Beckmann>},
    {evaluate_glass<Beckmann>, sample_glass<Beckmann>},
    {evaluate_ashikhmin_shirley, sample_ashikhmin_shirley},
    {nullptr, nullptr},
    {nullptr, nullptr},
    {nullptr, nullptr},
}};
const LobeFunctions& functions_of(const Lobe& lobe) { return kFunctions[static_cast<size_t>(lobe.type)]; }

// Returns the light pass of one side of a lobe. As in Cycles, the reflection side of glass is glossy.
size_t pass_of(const Lobe& lobe, bool transmitted) {
  const bool reflecting_glass = !transmitted && sides_of(lobe.type) == kBothSides;
  return static_cast<size_t>(reflecting_glass && lobe.pass == LightPass::Transmission ? LightPass::Glossy : lobe.pass);
}

bool is_diffuse(const Lobe& lobe) { return lobe.pass == LightPass::Diffuse; }

// Evaluates a lobe in its frame. It must not be inlined: sample() and evaluate() have to agree, and the density of a
// sharp lobe depends on where the compiler contracts multiplications and additions.
[[gnu::noinline]] BsdfEval evaluate_in_frame(const Lobe& lobe, const Vec3& wo, const Vec3& wi, uint8_t sides) {
  const Frame3 frame = make_frame(lobe.normal, lobe.tangent);
  return functions_of(lobe).evaluate(lobe, frame.to_local(wo), frame.to_local(wi), sides);
}

float stay_below_one(float u) { return std::min(u, 0.99999994f); }

}  // namespace

inline bool Closures::crosses(const Vec3& wi) const { return glm::dot(geometric_normal_, wi) < 0.0f; }

// This function and for_smooth() are inlined so that values stay in registers. A value that is stored by components and
// loaded as a vector would stall the processor.
[[gnu::always_inline]] inline BsdfEval Closures::evaluate_entry(const Entry& entry, const Vec3& wo, const Vec3& wi,
                                                                bool transmitted) const {
  const Lobe& source = lobes_[entry.lobe];
  // The sides of the shading and the geometric normal must agree, so that no light leaks through surfaces. Shifted
  // paths apply the same test.
  const float cos_i = glm::dot(wi, source.normal);
  if ((cos_i < 0.0f) != transmitted) {
    return {};
  }
  BsdfEval eval = is_lambert(source) ? evaluate_lambert(source, cos_i) : evaluate_in_frame(source, wo, wi, entry.sides);
  eval.pdf *= entry.probability;
  if (has_soft_bumps(source.type) && smooth_normal_ != Vec3(0.0f) && smooth_normal_ != source.normal) {
    eval.value *= shading_normals_ == GRADUS_SHADING_NORMALS_SINCE_4_5
                      ? bump_shadowing(smooth_normal_, source.normal, wi)
                      : cosine_bump_shadowing(smooth_normal_, source.normal, wi);
  }
  if (terminator_frequency_ > 1.0f && !transmitted) {
    eval.value *= terminator_shift(cos_i, terminator_frequency_);
  }
  return eval;
}

// Calls add(lobe, evaluation) for each smooth entry of a class.
template <class Add>
[[gnu::always_inline]] inline void Closures::for_smooth(ScatterClass c, const Vec3& wo, const Vec3& wi,
                                                        bool transmitted, Add&& add) const {
  const size_t k = static_cast<size_t>(c);
  for (int i = 0; i < entry_count_[k]; i++) {
    const Entry& entry = entries_[k][static_cast<size_t>(i)];
    if (!entry.dirac) {
      add(lobes_[entry.lobe], evaluate_entry(entry, wo, wi, transmitted));
    }
  }
}

BsdfEval Closures::evaluate_side(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const {
  BsdfEval sum;
  for_smooth(c, wo, wi, transmitted, [&](const Lobe&, const BsdfEval& part) {
    sum.value += part.value;
    sum.pdf += part.pdf;
  });
  return sum;
}

float Closures::direction_pdf(const Vec3& wo, const Vec3& wi) const {
  float pdf = 0.0f;
  for (int c = 0; c < kPathEvents; c++) {
    const auto k = static_cast<ScatterClass>(c);
    if (has_smooth(k)) {
      pdf += class_probability(k) * evaluate(k, wo, wi).pdf;
    }
  }
  return pdf;
}

BsdfEval Closures::evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi) const {
  return evaluate_side(c, wo, wi, crosses(wi));
}

KindEval Closures::evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi, bool diffuse) const {
  KindEval sum;
  for_smooth(c, wo, wi, crosses(wi), [&](const Lobe& lobe, const BsdfEval& part) {
    sum.all.value += part.value;
    sum.all.pdf += part.pdf;
    if (is_diffuse(lobe) == diffuse) {
      sum.kind.value += part.value;
      sum.kind.pdf += part.pdf;
    }
  });
  return sum;
}

std::array<Rgb, 3> Closures::evaluate_by_pass(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const {
  std::array<Rgb, 3> sum{Rgb(0.0f), Rgb(0.0f), Rgb(0.0f)};
  for_smooth(c, wo, wi, transmitted,
             [&](const Lobe& lobe, const BsdfEval& part) { sum[pass_of(lobe, transmitted)] += part.value; });
  return sum;
}

bool Closures::evaluate_dirac(int index, const Vec3& wo, bool transmitted, BsdfSample* out) const {
  const Lobe& source = lobe(index);
  if (!is_dirac(source.type)) {
    return false;
  }
  const size_t k = static_cast<size_t>(transmitted ? ScatterClass::Transmission : ScatterClass::Reflection);
  const Frame3 frame = make_frame(source.normal, source.tangent);
  Vec3 local;
  for (int i = 0; i < entry_count_[k]; i++) {
    const Entry& entry = entries_[k][static_cast<size_t>(i)];
    if (entry.lobe != index || !dirac_direction(source, frame.to_local(wo), transmitted, &local, &out->value)) {
      continue;
    }
    out->wi = glm::normalize(frame.to_world(local));
    if (terminator_frequency_ > 1.0f && !transmitted) {
      out->value *= terminator_shift(glm::dot(out->wi, source.normal), terminator_frequency_);
    }
    out->pdf = entry.probability;
    out->dirac = true;
    out->transmitted = transmitted;
    out->lobe = static_cast<uint8_t>(index);
    out->diffuse = is_diffuse(source);
    out->kind = {out->value, out->pdf};
    return crosses(out->wi) == transmitted;
  }
  return false;
}

int Closures::choose_subsurface(float u, float* probability) const {
  constexpr auto k = static_cast<size_t>(ScatterClass::Subsurface);
  int chosen = 0;
  while (chosen < entry_count_[k] - 1 && u >= entries_[k][static_cast<size_t>(chosen)].probability) {
    u -= entries_[k][static_cast<size_t>(chosen++)].probability;
  }
  const Entry& entry = entries_[k][static_cast<size_t>(chosen)];
  *probability = entry.probability;
  return entry.lobe;
}

bool Closures::sample(ScatterClass c, const Vec3& wo, float u_lobe, const Vec2& u, BsdfSample* out) const {
  const size_t k = static_cast<size_t>(c);
  if (entry_count_[k] == 0 || c == ScatterClass::Subsurface) {
    return false;
  }
  // u_lobe chooses the entry; its remainder, scaled to [0, 1), chooses the side.
  int chosen = 0;
  float remaining = u_lobe;
  while (chosen < entry_count_[k] - 1 && remaining >= entries_[k][static_cast<size_t>(chosen)].probability) {
    remaining -= entries_[k][static_cast<size_t>(chosen++)].probability;
  }
  const Entry& entry = entries_[k][static_cast<size_t>(chosen)];
  if (entry.dirac) {
    return evaluate_dirac(entry.lobe, wo, entry.sides == kTransmits, out);
  }
  const Lobe& source = lobes_[entry.lobe];
  const Frame3 frame = make_frame(source.normal, source.tangent);
  Vec3 local;
  if (!functions_of(source).sample(source, frame.to_local(wo), stay_below_one(remaining / entry.probability), u,
                                   entry.sides, &local)) {
    return false;
  }
  out->wi = renormalise(frame.to_world(local));
  out->diffuse = is_diffuse(source);
  BsdfEval all, kind;
  for_smooth(c, wo, out->wi, crosses(out->wi), [&](const Lobe& lobe, const BsdfEval& part) {
    all.value += part.value;
    all.pdf += part.pdf;
    if (is_diffuse(lobe) == out->diffuse) {
      kind.value += part.value;
      kind.pdf += part.pdf;
    }
  });
  out->value = all.value;
  out->pdf = all.pdf;
  out->kind = kind;
  out->dirac = false;
  out->transmitted = crosses(out->wi);
  out->lobe = entry.lobe;
  return all.pdf > 0.0f && is_finite(all.pdf) && is_finite(all.value);
}

bool Closures::transmits_clearly(ScatterClass c, const Vec3& wo, const Vec3& wi, float limit) const {
  float clear = 0.0f, rough = 0.0f;
  for_smooth(c, wo, wi, true, [&](const Lobe& lobe, const BsdfEval& part) {
    const bool is_clear = is_microfacet(lobe.type) && lobe.alpha_x * lobe.alpha_y <= limit;
    (is_clear ? clear : rough) += mean_component(part.value);
  });
  return clear > rough;
}

LightPass Closures::light_pass(int lobe, bool transmitted) const {
  return static_cast<LightPass>(pass_of(this->lobe(lobe), transmitted));
}

namespace {

// Returns the sum over the lobes of a pass of their albedos, which a function returns.
Rgb sum_of_pass(const Closures& closures, LightPass pass, const Vec3& wo, LobeAlbedo (*albedo_of)(const Lobe&, float)) {
  Rgb sum(0.0f);
  for (int i = 0; i < closures.count(); i++) {
    const Lobe& lobe = closures.lobe(i);
    const LobeAlbedo albedo = albedo_of(lobe, glm::dot(lobe.normal, wo));
    sum += pass_of(lobe, false) == static_cast<size_t>(pass) ? albedo.reflected : Rgb(0.0f);
    sum += pass_of(lobe, true) == static_cast<size_t>(pass) ? albedo.transmitted : Rgb(0.0f);
  }
  return sum;
}

}  // namespace

Rgb Closures::albedo(LightPass pass, const Vec3& wo) const { return sum_of_pass(*this, pass, wo, shown_albedo); }

Rgb Closures::albedo(const Vec3& wo) const {
  const auto of_pass = [&](LightPass pass) { return sum_of_pass(*this, pass, wo, two_sided_albedo); };
  return of_pass(LightPass::Diffuse) + of_pass(LightPass::Glossy) + of_pass(LightPass::Transmission);
}

}  // namespace gradus::bsdf
