// Weights of gradient samples (thesis 5.4.1, equation 5.24; contract 1.5).
//
// A gradient I_q − I_p is sampled from both ends: by base paths x of p, shifted to y = T(x), and by base paths of q,
// shifted back. With the balance heuristic over m_p samples of density p(x) and m_q of density p(y)·|T'| in the measure
// of x, and with C = f(x)/p(x), C' = f(y)/p(y), r = |T'|·p(y)/p(x), a sample of p's end is
//   (r·C' − C) / (m_p + m_q·r)
// and −C/m_p where no shift exists: then the other end never sees x. Sums are multiplied by (m_p + m_q)/2; a sample
// that was taken counts (m_p + m_q)/(2 m_p) in what they are divided by when read.
#pragma once

#include "film/film.h"

namespace gradus::gradient {

struct PairCount {
  float own = 0.0f;    // samples of this batch and half at the base's pixel
  float other = 0.0f;  // and at the offset's
  bool present() const { return own > 0.0f && other > 0.0f; }
  // 0 for absent pairs. Equal counts give exactly 1.
  float weight() const { return present() ? 0.5f * (1.0f + other / own) : 0.0f; }

  // Written by the quotient of the counts: equal counts give the same bits in batches of any size.
  Radiance paired(const Radiance& base, const Radiance& offset, float r) const {
    const float q = other / own;
    return (r * offset - base) * (0.5f * (1.0f + q) / (1.0f + q * r));
  }
  Radiance unpaired(const Radiance& base) const { return base * (-0.5f * (1.0f + other / own)); }
};

}  // namespace gradus::gradient
