// Makes vectors between two images exact, from a start that is near: the windows of Lucas and Kanade within the
// smoothness of Horn and Schunck (Bruhn, Weickert and Schnörr 2005), both robust. Derivation and measurements:
// docs/method.md, "Motion of shadows and of the rest".
#pragma once

#include <cstdint>
#include <vector>

#include "motion/film_plane.h"

namespace gradus::motion {

struct FlowPair {
  FilmPlane<float> from, to;
  std::span<const float> noise;     // by pixels: standard deviation of a level of either, above 0
  std::span<const Vec2> bootstrap;  // by pixels of `from`, in pixels: known motion; what is beside it is smooth
  std::span<const uint8_t> seen;    // whether `to` can show what the pixel shows; where not, vectors are filled in
  std::span<const int32_t> object;  // between two of them nothing is smooth
};

// `rest`: by pixels of `from`, so that bootstrap + rest leads to the same level in `to`. In: where to start. It stays
// finite.
void refine_flow(const FlowPair& pair, std::vector<Vec2>* residual);

}  // namespace gradus::motion
