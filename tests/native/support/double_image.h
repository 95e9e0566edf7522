// The image in double precision: throughputs, weights and sums are recomputed from the values and densities that
// sampling found in float.
#pragma once

#include <vector>

#include "integrator/integrator.h"

namespace gradus::test {

struct DoubleImage {
  std::vector<float> image;   // of the plain path tracer, RGB
  std::vector<double> mean;   // the same in double
  std::vector<double> error;  // standard error of the mean
  // Returns the largest difference of a value of the image, in units of its bound: 1 % of the standard error, plus 1e-6
  // of the value for rounding.
  double worst() const;
};

// Samples that are not finite in float are in neither image.
DoubleImage render_in_double(const integrator::IntegratorContext& context, uint32_t samples);

}  // namespace gradus::test
