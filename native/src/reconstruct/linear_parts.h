// What a linear operator makes of the parts of a sum (contract 3.4).
#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/field_values.h"

namespace gradus {

void subtract(const Field& part, Field* from);
// The part with most light; of several with as much the first.
size_t brightest(const std::vector<Field>& parts);

// Each part becomes what apply(part's number, part) makes of it, which is not asked about black ones. The brightest is what the others
// leave of `whole`, what the operator makes of the sum: so parts add up whatever the rounding, and the dearest costs nothing.
template <class Apply>
void apply_to_parts(const Field& whole, const Apply& apply, std::vector<Field>* parts) {
  const size_t rest = brightest(*parts);
  Field left = whole;
  for (size_t k = 0; k < parts->size(); ++k) {
    if (k == rest || is_black((*parts)[k])) continue;
    (*parts)[k] = apply(k, (*parts)[k]);
    subtract((*parts)[k], &left);
  }
  (*parts)[rest] = std::move(left);
}

}  // namespace gradus
