// Application of one linear operator to all terms of a sum, so that the results add up exactly.
#pragma once

#include <cstddef>
#include <vector>

#include "base/fault.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {

// Subtracts `term` from `from`, which has the same size.
void subtract(const Field& term, Field* from);
// Returns the index of the term with the largest sum of absolute RGB values; the first of several equal ones.
size_t brightest(const std::vector<Field>& terms);

// Replaces each term k by apply(k, term). `whole` is what the operator makes of the sum of the terms. Black terms are
// skipped. The brightest term becomes `whole` minus all others: the terms then add up in spite of rounding, and the
// most expensive term costs nothing.
template <class Apply>
void apply_to_terms(const Field& whole, const Apply& apply, std::vector<Field>* terms) {
  const size_t remainder = brightest(*terms);
  Field left = whole;
  for (size_t k = 0; k < terms->size(); ++k) {
    if (k == remainder || is_black((*terms)[k])) continue;
    (*terms)[k] = apply(k, (*terms)[k]);
    if (!GRADUS_FAULT(remainder_not_subtracted)) subtract((*terms)[k], &left);
  }
  (*terms)[remainder] = std::move(left);
}

}  // namespace gradus::reconstruct
