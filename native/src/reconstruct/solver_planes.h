// Primal and differences as the iterative solvers' fields.
#pragma once

#include "base/types.h"
#include "reconstruct/field.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

struct SolverPlanes {
  SolverPlanes(int width, int height, int channels)
      : primal(width, height, channels), dx(width, height, channels), dy(width, height, channels) {}
  Field primal, dx, dy;
};

// Takes channels [0, channels) from interleaved planes.
SolverPlanes load_planes(const PoissonPlanes& planes, int width, int height, int channels);
// The middle one; 1 of none. Reorders them.
float median_or_one(std::vector<float>* values);
// Scale of the image: the median of the luminances that are not 0; 1 for a black image. Residuals and noise are
// measured in it.
float robust_scale(const Field& image);
// Whether a row's value is there in all of some channels, interleaved.
inline bool is_complete(const float* value, int channels) {
  bool complete = true;
  for (int c = 0; c < channels; ++c) complete = complete && is_finite(value[c]);
  return complete;
}
// Writes one channel of a field as every `stride`-th value of `out`.
void store_channel(const Field& from, int channel, size_t stride, float* out);
// An image of the first channels, interleaved.
std::vector<float> interleave(const Field& field, int channels);
inline std::vector<float> interleave(const Field& field) { return interleave(field, field.channels()); }

}  // namespace gradus::reconstruct
