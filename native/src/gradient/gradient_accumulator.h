// Weights gradient samples and sums them over one base path (Manzi 2016, section 5.4.1, equation 5.24).
//
// A gradient I_q − I_p is sampled from both ends: by base paths x of p, shifted to y = T(x), and by base paths of q
// with the inverse shift. Let m_p be the number of samples of p with density p(x), and m_q that of q with density
// p(y)·|T'| in the measure of x. Let C = f(x)/p(x), C' = f(y)/p(y) and r = |T'|·p(y)/p(x). With the balance heuristic a
// sample of p's end is
//   (r·C' − C) / (m_p + m_q·r)
// or −C/m_p where no shift exists, because then q's end never samples x. Stored sums are multiplied by (m_p + m_q)/2.
// Each sample adds (m_p + m_q)/(2 m_p) to the weight by which the sum is divided when it is read. So neighbours with
// different sample counts are weighted by the counts of their batch.
#pragma once

#include "gradient/offset_path.h"
#include "gradient/shifted_event.h"

namespace gradus::gradient {

struct PairCount {
  float own = 0.0f;    // number of samples of the base's pixel in this batch and half-buffer
  float other = 0.0f;  // number of samples of the offset's pixel in the same batch and half-buffer
  // Returns whether both ends have samples. A pair with no samples at one end is absent.
  bool present() const { return own > 0.0f && other > 0.0f; }
  // Returns what one sample adds to the weight of the pair: 0 for absent pairs, exactly 1 for equal counts.
  float weight() const { return present() ? 0.5f * (1.0f + other / own) : 0.0f; }

  // Returns the gradient sample of a base contribution C and its shifted contribution C' with ratio r. It uses only the
  // quotient of the counts, so equal counts give the same bits in batches of any size.
  Radiance paired(const Radiance& base, const Radiance& offset, float r) const {
    const float q = other / own;
    return (r * offset - base) * (0.5f * (1.0f + q) / (1.0f + q * r));
  }
  // Returns the gradient sample of a base contribution without a shifted path.
  Radiance unpaired(const Radiance& base) const { return base * (-0.5f * (1.0f + other / own)); }
};
using PairCounts = std::array<PairCount, film::kOffsets>;

// What an offset path contributes where its base path contributes C.
struct ShiftedContribution {
  bool is_paired = false;                     // otherwise the base's contribution is unpaired
  ShiftFailure failure = ShiftFailure::None;  // the cause to count if it is unpaired
  Rgb value = Rgb(0.0f);                      // C' = f(y)/p(y), before clamping
  float ratio = 0.0f;                         // r
};
inline ShiftedContribution unpaired(ShiftFailure failure = ShiftFailure::None) { return {false, failure}; }
inline ShiftedContribution paired(const Rgb& value, float ratio) { return {true, ShiftFailure::None, value, ratio}; }

class GradientAccumulator {
 public:
  GradientAccumulator(const path::PathContext& context, OffsetPaths* offsets, film::Counters* counters);

  // Prepares for a base path with these sample counts at the two ends of its pairs.
  void start(const PairCounts& pairs);
  // Returns the weighted gradient sample of each pair for one component, alpha included. Valid after flush().
  const std::array<Radiance, film::kOffsets>& gradient(int component) const { return gradient_[size_t(component)]; }
  bool has_pair(int k) const { return pairs_[size_t(k)].present(); }

  // Adds the contribution c of the base and what offset k contributes in its place.
  void add(int k, const path::Contribution& c, const ShiftedContribution& offset);
  // Adds a pair of contributions to a component.
  void add_pair(int k, int component, const Radiance& base, const Radiance& offset, float ratio);

  // The suffix holds contributions of the base since the last flush(). All of them lie behind the vertices that offsets
  // in final stages share, so one gradient sample for each offset covers their sum.
  //
  // Adds a contribution of the base behind a segment of the given weight, for all offsets in final stages.
  void add_to_suffix(const path::Contribution& c, const Rgb& segment_weight);
  // Multiplies the throughput of the path from here on.
  void scale_suffix(const Rgb& factor) {
    suffix_.is_empty = false;
    suffix_.weight *= factor;
  }
  // Returns the factor by which the throughput has changed since the last flush().
  const Rgb& suffix_weight() const { return suffix_.weight; }
  // Turns the suffix into gradient samples. Must be called before an offset enters a final stage.
  void flush();

 private:
  void add_unpaired(int k, const path::Contribution& c) {
    gradient_[size_t(c.component)][size_t(k)] += pairs_[size_t(k)].unpaired(Radiance(c.clamped, 0.0f));
  }

  struct Suffix {
    bool is_empty = true;
    int component = 0;       // component of the contributions
    Rgb weight = Rgb(1.0f);  // factor by which the throughput has changed
    Rgb base = Rgb(0.0f);    // sum of the base's contributions
    Rgb tail = Rgb(0.0f);    // sum of the contributions of a path with throughput 1
  };

  const path::PathContext& context_;
  OffsetPaths& offsets_;
  film::Counters& counters_;
  const bool clamps_;  // each contribution is clamped separately, so that contributions cannot be summed
  PairCounts pairs_{};
  Suffix suffix_;
  std::array<std::array<Radiance, film::kOffsets>, lpe::kMaxComponents> gradient_{};
};

}  // namespace gradus::gradient
