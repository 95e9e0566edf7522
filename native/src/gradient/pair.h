// Weights of gradient samples (thesis, section 5.4.1, equation 5.24).
//
// A gradient I_q − I_p is sampled from both ends: by base paths x of p, shifted to y = T(x), and by base paths of q
// with the inverse shift. Let m_p be the number of samples of p with density p(x), and m_q that of q with density
// p(y)·|T'| in the measure of x. Let C = f(x)/p(x), C' = f(y)/p(y) and r = |T'|·p(y)/p(x). With the balance heuristic a
// sample of p's end is
//   (r·C' − C) / (m_p + m_q·r)
// or −C/m_p where no shift exists, because then q's end never samples x. Stored sums are multiplied by (m_p + m_q)/2.
// Each sample adds (m_p + m_q)/(2 m_p) to the weight by which the sum is divided when it is read. So neighbours with
// different sample counts are weighted by the counts of their batch.
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

}  // namespace gradus::gradient
