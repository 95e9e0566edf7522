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

// Returns whether a lobe takes directions from the guide. Narrower lobes find their light by themselves.
bool may_be_guided(const Lobe& lobe) { return lobe.type == LobeType::Diffuse; }

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

// Calls add(lobe, evaluation, density without the guide) for each smooth entry of a class.
template <class Add>
[[gnu::always_inline]] inline void Closures::for_smooth(ScatterClass c, const Vec3& wo, const Vec3& wi,
                                                        bool transmitted, Add&& add) const {
  const size_t k = static_cast<size_t>(c);
  const bool is_guided = guides(c);
  const float guided_pdf = is_guided ? guide_.pdf(wi) : 0.0f;
  for (int i = 0; i < entry_count_[k]; i++) {
    const Entry& entry = entries_[k][static_cast<size_t>(i)];
    if (entry.dirac) continue;
    const Lobe& lobe = lobes_[entry.lobe];
    BsdfEval eval = evaluate_entry(entry, wo, wi, transmitted);
    const float unguided_pdf = eval.pdf;
    if (is_guided && may_be_guided(lobe))
      eval.pdf = (1.0f - guided_share_) * unguided_pdf + guided_share_ * (guided_pdf * entry.probability);
    add(lobe, eval, unguided_pdf);
  }
}

BsdfEval Closures::evaluate_side(ScatterClass c, const Vec3& wo, const Vec3& wi, bool transmitted) const {
  BsdfEval sum;
  for_smooth(c, wo, wi, transmitted, [&](const Lobe&, const BsdfEval& part, float) {
    sum.value += part.value;
    sum.pdf += part.pdf;
  });
  return sum;
}

float Closures::unguided_pdf(const Vec3& wo, const Vec3& wi) const {
  float pdf = 0.0f;
  for (int c = 0; c < kPathEvents; c++) {
    const auto k = static_cast<ScatterClass>(c);
    float of_class = 0.0f;
    for_smooth(k, wo, wi, crosses(wi), [&](const Lobe&, const BsdfEval&, float part) { of_class += part; });
    pdf += class_probability(k) * of_class;
  }
  return pdf;
}

float Closures::guided_ratio(ScatterClass c, const Vec3& wo, const Vec3& wi, std::optional<bool> diffuse) const {
  if (!guides(c)) return 1.0f;
  float guided = 0.0f, unguided = 0.0f;
  for_smooth(c, wo, wi, crosses(wi), [&](const Lobe& lobe, const BsdfEval& part, float part_unguided) {
    if (diffuse && *diffuse != is_diffuse(lobe)) return;
    guided += part.pdf;
    unguided += part_unguided;
  });
  return unguided > 0.0f ? guided / unguided : 1.0f;
}

BsdfEval Closures::evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi) const {
  return evaluate_side(c, wo, wi, crosses(wi));
}

KindEval Closures::evaluate(ScatterClass c, const Vec3& wo, const Vec3& wi, bool diffuse) const {
  KindEval sum;
  for_smooth(c, wo, wi, crosses(wi), [&](const Lobe& lobe, const BsdfEval& part, float) {
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
             [&](const Lobe& lobe, const BsdfEval& part, float) { sum[pass_of(lobe, transmitted)] += part.value; });
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
    out->unguided_pdf = out->unguided_kind_pdf = out->pdf;
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
  // u_lobe chooses the entry; its remainder, scaled to [0, 1), chooses the side, or whether the direction is guided.
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
  const float u_entry = stay_below_one(remaining / entry.probability);
  Vec3 local;
  if (guides(c) && may_be_guided(source) && u_entry < guided_share_) {
    out->wi = renormalise(guide_.sample(u_entry / guided_share_, u));
  } else if (functions_of(source).sample(source, frame.to_local(wo), u_entry, u, entry.sides, &local)) {
    out->wi = renormalise(frame.to_world(local));
  } else {
    return false;
  }
  out->diffuse = is_diffuse(source);
  out->unguided_pdf = out->unguided_kind_pdf = 0.0f;
  BsdfEval all, kind;
  for_smooth(c, wo, out->wi, crosses(out->wi), [&](const Lobe& lobe, const BsdfEval& part, float unguided_pdf) {
    all.value += part.value;
    all.pdf += part.pdf;
    out->unguided_pdf += unguided_pdf;
    if (is_diffuse(lobe) == out->diffuse) {
      kind.value += part.value;
      kind.pdf += part.pdf;
      out->unguided_kind_pdf += unguided_pdf;
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
  for_smooth(c, wo, wi, true, [&](const Lobe& lobe, const BsdfEval& part, float) {
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
