// Application of one linear operator to all terms of a sum, so that the results add up exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/fault.h"
#include "base/rows.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {

// Subtracts `term` from `from`, which has the same size.
inline void subtract(const Field& term, Field* from) {
  for_values(from, [&](float& value, int x, int y, int c) { value -= term.row(y, c)[x]; });
}

// Returns the sum of absolute RGB values.
inline double sum_of_magnitudes(const Field& field) {
  const Sums sums = sum_rows(field.height(), 1, [&](int y, int) {
    double sum = 0.0;
    for (int c = 0; c < std::min(field.channels(), 3); ++c) {
      for (int x = 0; x < field.width(); ++x) sum += std::fabs(double(field.row(y, c)[x]));
    }
    return sum;
  });
  return sums[0];
}

// Returns the index of the term with the largest sum of absolute RGB values; the first of several equal ones.
inline size_t brightest(const std::vector<Field>& terms) {
  std::vector<double> light;
  for (const Field& term : terms) light.push_back(sum_of_magnitudes(term));
  return size_t(std::max_element(light.begin(), light.end()) - light.begin());
}

// Replaces each term k by apply(k, term). `whole` is what the operator makes of the sum of the terms. The brightest
// term becomes `whole` minus all others: the terms then add up in spite of rounding, and the most expensive term costs
// nothing.
template <class Apply>
void apply_to_terms(const Field& whole, const Apply& apply, std::vector<Field>* terms) {
  const size_t remainder = brightest(*terms);
  Field left = whole;
  for (size_t k = 0; k < terms->size(); ++k) {
    if (k == remainder) continue;
    (*terms)[k] = apply(k, (*terms)[k]);
    if (!GRADUS_FAULT(remainder_not_subtracted)) subtract((*terms)[k], &left);
  }
  (*terms)[remainder] = std::move(left);
}

}  // namespace gradus::reconstruct
