// Denoising features read from a frame, with what is known of their noise: they guide reconstructions.
#pragma once

#include "film/film.h"
#include "film/film_header.h"

namespace gradus::film {

// Planes of the region, row-major, channels interleaved.
struct FeatureImage {
  uint32_t channels = 0;
  std::vector<float> values;  // means over the samples of the halves that are read; 0 where there are none
  // Of the mean over both halves: ((A − B)/2)² per channel (contract 1.2), NaN where a half has no samples. Empty where
  // one half is read.
  std::vector<float> variance;
};

struct Features {
  int width = 0, height = 0;
  FeatureImage normal;  // in the world, as shaded
  FeatureImage albedo;  // in [0, 1]; of what shines, its light
  FeatureImage depth;   // length of the path to where the others are taken, 0 where it meets nothing such
};

bool has_features(const Film& film);
bool has_features(const FilmHeader& header);
// All three. halves: both, or one alone. Throws invalid_operation for a frame without them.
Features read_features(const Film& film, HalfRange halves = {});
// One of the passes that are kept in halves; else as above.
FeatureImage read_feature(const Film& film, uint32_t pass, HalfRange halves = {});

}  // namespace gradus::film
