// An image of sampled light and the difference of its half-buffers, as input of the regression.
#pragma once

#include "base/fault.h"
#include "film/film.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {

// Three channels. After normalise() the unit is the image's median luminance.
struct HalvedImage {
  Field mean;
  Field half_difference;  // (A − B)/2; an estimate where a half-buffer has no samples
};

// Sums of the samples of one pixel in both half-buffers.
using HalfSums = std::array<Rgb, film::kHalves>;

// Replaces half differences that are not finite, of pixels where a half-buffer has no samples. The replacement is the
// pixel's deviation from the mean of the pixels around it, which is too large where there is detail and rarely too
// small elsewhere.
void guess_noise(HalvedImage* image);

// Reads the means and half differences of a film from the sums that sums_at(pixel) returns and the film's sample
// counts. A mean that is not finite becomes 0.
template <class SumsAt>
HalvedImage read_halves(const film::Film& film, const SumsAt& sums_at) {
  const int w = film.region.width(), h = film.region.height();
  HalvedImage image{Field(w, h, 3), Field(w, h, 3)};
  for_rows(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const size_t i = size_t(y) * size_t(w) + size_t(x);
      const HalfSums sums = sums_at(i);
      const auto a = float(film.count[0][i]), b = float(film.count[1][i]);
      for (int c = 0; c < 3; ++c) {
        const float mean = (sums[0][c] + sums[1][c]) / (a + b);
        image.mean.row(y, c)[x] = is_finite(mean) ? mean : 0.0f;
        const float sign = GRADUS_FAULT(sum_of_halves_taken_for_difference) ? -1.0f : 1.0f,
                    half = GRADUS_FAULT(image_variance_times_4)  ? 1.0f
                           : GRADUS_FAULT(image_variance_over_4) ? 0.25f
                                                                 : 0.5f;
        image.half_difference.row(y, c)[x] = half * (sums[0][c] / a - sign * sums[1][c] / b);
      }
    }
  });
  guess_noise(&image);
  return image;
}

// Largest magnitude of a pixel in median luminances, so that sums of its square fit in a float.
inline constexpr float kMaxInMedians = 1e12f;
// Divides both images by `scale` and clamps them to ±kMaxInMedians.
void normalise(float scale, HalvedImage* image);

}  // namespace gradus::reconstruct
