// Where samples beyond the usual number pay: at edges between surfaces of which one is much brighter than the other.
//
// A regression, or a denoiser, smooths the noise of light within surfaces. At edges it finds few pixels to join, and
// what is left of the error, and nearly all flicker, lies in a few hundredths of the pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "film/film.h"

namespace gradus::render {

// Number of samples from which edges are looked for.
inline constexpr uint32_t kEdgeCheck = 4;

// Returns the further samples of each pixel, for a batch of `usual` ones: an even number, 0 away from edges, and half
// of `usual` at most on average; empty if there are none. What a pixel gets depends on the samples of the pixels around
// it, and on its own only through what those got before, the average and the net of points that pixels share, so that
// its mean stays unbiased but for that. The film must keep denoising features.
std::vector<uint32_t> further_samples_at_edges(const film::Film& film, uint32_t usual);

}  // namespace gradus::render
