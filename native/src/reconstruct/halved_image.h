// What is known of light that is reconstructed: what was sampled of it, and by how much the two halves disagree.
#pragma once

#include "film/film.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {

// Three channels, in the scale of 1 for its median luminance once it is normalised.
struct HalvedImage {
  Field mean;
  Field half_difference;  // (A − B)/2; a guess where a half has no samples
  bool is_light = true;   // not negative; else changes of it
};

// Of a pixel's light.
using HalfSums = std::array<Rgb, film::kHalves>;

// Where a half has no samples nothing is known of the noise: its half difference is not finite. What differs from the
// pixels around stands for it: too much where there is detail, and hardly too little elsewhere.
void guess_noise(HalvedImage* image);

// From sums_at(pixel), by the samples that the frame has taken there; a mean that is not finite is 0.
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
        image.half_difference.row(y, c)[x] = 0.5f * (sums[0][c] / a - sums[1][c] / b);
      }
    }
  });
  guess_noise(&image);
  return image;
}

// Brings what was read into that scale, within bounds.
void normalise(float scale, HalvedImage* image);

}  // namespace gradus::reconstruct
