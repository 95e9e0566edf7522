// Removal of noise from features. Lens blur, motion blur, edges and rough mirrors leave noise in features, which would
// spread to the images that the features guide.
//
// Each feature is filtered by itself by NL-means over 3×3 pixels, with patches of 3×3 pixels and the measured variance
// (Rousselle, Manzi, Zwicker 2013, "Robust Denoising using Feature and Color Information", §4). Pixels are averaged if
// they differ by no more than their noise, so noise-free features remain unchanged.
#pragma once

#include "film/features.h"

namespace gradus::reconstruct {

// Returns the image with filtered values; its variance remains that of the sampled values. Values that are not finite
// count as 0. The noise is unknown where a half-buffer has no samples, and counts as 0 there.
film::FeatureImage filter_feature(film::FeatureImage image, int width, int height);
film::Features filter_features(film::Features features);

}  // namespace gradus::reconstruct
