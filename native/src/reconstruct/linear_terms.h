// What a linear operator makes of the parts of a sum (contract 3.4).
#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/field_values.h"

namespace gradus::reconstruct {

void subtract(const Field& term, Field* from);
// The part with most light; of several with as much the first.
size_t brightest(const std::vector<Field>& terms);

// Each part becomes what apply(part's number, part) makes of it, which is not asked about black ones. The brightest is
// what the others leave of `whole`, what the operator makes of the sum: so parts add up whatever the rounding, and the
// dearest costs nothing.
template <class Apply>
void apply_to_terms(const Field& whole, const Apply& apply, std::vector<Field>* terms) {
  const size_t remainder = brightest(*terms);
  Field left = whole;
  for (size_t k = 0; k < terms->size(); ++k) {
    if (k == remainder || is_black((*terms)[k])) continue;
    (*terms)[k] = apply(k, (*terms)[k]);
    subtract((*terms)[k], &left);
  }
  (*terms)[remainder] = std::move(left);
}

}  // namespace gradus::reconstruct
