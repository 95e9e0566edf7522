// Reads the denoising features (normal, albedo, depth) of a film with estimates of their variance. Reconstruction and
// denoising use them as guides.
#pragma once

#include "film/film.h"
#include "film/film_header.h"

namespace gradus::film {

// One feature over the film's region: row-major, channels interleaved.
struct FeatureImage {
  uint32_t channels = 0;
  std::vector<float> values;  // means over the samples of the half-buffers read; 0 where there are no samples
  // Estimated variance of the mean over both half-buffers A and B: ((A − B)/2)² per channel, NaN where one of them has
  // no samples. Empty if only one half-buffer is read.
  std::vector<float> variance;
};

struct Features {
  int width = 0, height = 0;
  FeatureImage normal;  // shading normal in world space
  FeatureImage albedo;  // in [0, 1]; the emitted light for emitters
  FeatureImage depth;   // length of the path to the vertex that gives normal and albedo; 0 if there is no such vertex
};

// Returns whether all three features are kept.
bool has_features(const Film& film);
bool has_features(const FilmHeader& header);
// Reads all three features from both half-buffers or from one. Throws invalid_operation if the film does not keep them.
Features read_features(const Film& film, HalfRange halves = {});
// Reads one pass that is kept in half-buffers. Throws invalid_operation if the film does not keep the pass in
// half-buffers.
FeatureImage read_feature(const Film& film, uint32_t pass, HalfRange halves = {});

}  // namespace gradus::film
