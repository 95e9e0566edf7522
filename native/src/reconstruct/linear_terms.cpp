#include "reconstruct/linear_terms.h"

#include <algorithm>
#include <cmath>

#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

double light_of(const Field& field) {
  const Sums sums = sum_rows(field.height(), 1, [&](int y, int) {
    double sum = 0.0;
    for (int c = 0; c < std::min(field.channels(), 3); ++c) {
      for (int x = 0; x < field.width(); ++x) sum += std::fabs(double(field.row(y, c)[x]));
    }
    return sum;
  });
  return sums[0];
}

}  // namespace

void subtract(const Field& term, Field* from) {
  for_values(from, [&](float& value, int x, int y, int c) { value -= term.row(y, c)[x]; });
}

size_t brightest(const std::vector<Field>& terms) {
  std::vector<double> light;
  for (const Field& term : terms) light.push_back(light_of(term));
  return size_t(std::max_element(light.begin(), light.end()) - light.begin());
}

}  // namespace gradus::reconstruct
