#pragma once

#include "compare/metrics.h"

namespace gradus::compare {

// Mean structural similarity (Wang et al. 2004, "Image quality assessment: from error visibility to structural
// similarity") of the luminances after the sRGB curve; 1 for equal images. Values that are not finite count as 0.
double structural_similarity(const RgbImage& image, const RgbImage& reference);

}  // namespace gradus::compare
