// Features without their noise: what lens, motion, edges and rough mirrors leave in them would go on into whatever they
// guide.
//
// NL-means of each feature by itself over 3×3 pixels, by patches of 3×3 and the measured variance (Rousselle, Manzi,
// Zwicker 2013, "Robust Denoising using Feature and Color Information", §4): pixels count that differ by no more than
// their noise, so that clean features stay.
#pragma once

#include "film/features.h"

namespace gradus::reconstruct {

// The values filtered; variance stays that of the sampled ones. What is not finite counts as 0. Where a half has no
// samples nothing is known of the noise, and it counts as none.
film::FeatureImage filter_feature(film::FeatureImage image, int width, int height);
film::Features filter_features(film::Features features);

}  // namespace gradus::reconstruct
