// Conversion between interleaved images and the fields of the iterative solvers.
#pragma once

#include "base/types.h"
#include "reconstruct/field.h"
#include "reconstruct/poisson/solver.h"

namespace gradus::reconstruct {

struct SolverPlanes {
  SolverPlanes(int width, int height, int channels)
      : primal(width, height, channels), dx(width, height, channels), dy(width, height, channels) {}
  Field primal, dx, dy;
};

// Copies channels [0, channels) of interleaved planes.
SolverPlanes load_planes(const PoissonPlanes& planes, int width, int height, int channels);
// Returns the median, or 1 if there are no values. Reorders them.
float median_or_one(std::vector<float>* values);
// Returns the scale of an image: the median of the positive luminances, or 1 for a black image. Residuals and noise are
// measured in this unit.
float robust_scale(const Field& image);
// Returns whether the interleaved values of a pixel are finite in all `channels` channels.
inline bool is_complete(const float* value, int channels) {
  bool complete = true;
  for (int c = 0; c < channels; ++c) complete = complete && is_finite(value[c]);
  return complete;
}
// Writes one channel of a field to every `stride`-th value of `out`.
void store_channel(const Field& from, int channel, size_t stride, float* out);
// Returns an image of the first `channels` channels, interleaved.
std::vector<float> interleave(const Field& field, int channels);
inline std::vector<float> interleave(const Field& field) { return interleave(field, field.channels()); }
// Returns the colours of an interleaved image, which may have further channels.
Field colors_of(const std::vector<float>& image, int width, int height);

}  // namespace gradus::reconstruct
