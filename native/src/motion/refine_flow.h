// Refines vectors between two images from an estimate. It combines the windows of Lucas and Kanade with the smoothness
// of Horn and Schunck (Bruhn, Weickert and Schnörr 2005), both with robust penalties. Derivation and measurements are
// in docs/method.md, "Motion of shadows and of the rest".
#pragma once

#include <cstdint>
#include <vector>

#include "motion/film_plane.h"

namespace gradus::motion {

struct FlowPair {
  FilmPlane<float> from, to;
  std::span<const float> noise;     // standard deviation of a level of either image at each pixel, above 0
  std::span<const Vec2> bootstrap;  // known motion of each pixel of `from`, in pixels; the residual motion is smooth
  std::span<const uint8_t> seen;    // whether `to` can show what a pixel shows; otherwise its vector is filled in
  std::span<const int32_t> object;  // number of the object; there is no smoothness between different objects
};

// Refines *residual, the vector of each pixel of `from` for which bootstrap + residual leads to the same level in `to`.
// On input it holds the start. Finite vectors stay finite.
void refine_flow(const FlowPair& pair, std::vector<Vec2>* residual);

}  // namespace gradus::motion
