#include "film/features.h"

#include <algorithm>
#include <limits>
#include <string>

#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/fault.h"
#include "base/fpu.h"
#include "film/film.h"
#include "schema/pass_table.h"

namespace gradus::film {

namespace {

// Calls function(pixel index) for all pixels of the region, with rows distributed over the threads.
template <class Function>
void for_pixels(const Film& film, const Function& function) {
  const auto width = static_cast<size_t>(film.region.width());
  tbb::parallel_for(0, film.region.height(), [&](int y) {
    const FlushDenormals flush;
    for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i) function(i);
  });
}

void read_mean(const Film& film, const Channel& plane, HalfRange halves, size_t pixel, float* to) {
  uint32_t count = 0;
  for (int h = halves.first; h < halves.last; ++h) count += film.count[h][pixel];
  const float factor = count > 0 ? 1.0f / static_cast<float>(count) : 0.0f;
  for (uint32_t c = 0; c < plane.info.values_per_pixel; ++c) {
    float sum = 0.0f;
    for (int h = halves.first; h < halves.last; ++h)
      sum +=
          plane
              .values[GRADUS_FAULT(feature_half_buffer_a_added_twice) ? 0 : h][plane.info.values_per_pixel * pixel + c];
    to[c] = factor * sum;
  }
}

// Returns the estimated variance of a mean. half: half the difference between the means of half-buffers A and B.
float variance_of(float half, bool is_known) {
  return is_known ? std::min(half * half, kMaxFloat) : std::numeric_limits<float>::quiet_NaN();
}

void read_variance(const Film& film, const Channel& plane, size_t pixel, float* to) {
  const uint32_t a = film.count[0][pixel], b = film.count[1][pixel];
  for (uint32_t c = 0; c < plane.info.values_per_pixel; ++c) {
    const size_t i = plane.info.values_per_pixel * pixel + c;
    const float mean_a = plane.values[0][i] / static_cast<float>(a),
                mean_b = plane.values[1][i] /
                         static_cast<float>(GRADUS_FAULT(feature_half_buffer_b_divided_by_count_of_a) ? a : b);
    const float half = (GRADUS_FAULT(feature_variance_times_4)  ? 1.0f
                        : GRADUS_FAULT(feature_variance_over_4) ? 0.25f
                                                                : 0.5f) *
                       (mean_a - mean_b);
    to[c] = variance_of(half, a > 0 && b > 0);
  }
}

}  // namespace

bool holds_features(uint64_t planes) { return (planes & schema::feature_passes()) == schema::feature_passes(); }

bool has_features(const FilmHeader& header) { return holds_features(header.planes); }
bool has_features(const Film& film) { return holds_features(film.channels.passes()); }

FeatureImage read_feature(const Film& film, uint32_t pass, HalfRange halves) {
  const Channel* plane = film.channels.of_pass(pass);
  if (plane == nullptr || !plane->info.in_halves) {
    throw invalid_operation("the film does not keep " + std::string(schema::pass_info(pass).name) + " in halves");
  }
  FeatureImage image;
  image.channels = plane->info.values_per_pixel;
  image.values.resize(plane->values[0].size());
  for_pixels(film, [&](size_t i) {
    const size_t from = GRADUS_FAULT(features_read_one_pixel_early) && i > 0 ? i - 1 : i;
    read_mean(film, *plane, halves, from, image.values.data() + i * image.channels);
  });
  if (halves.last - halves.first == kHalves) {
    image.variance.resize(image.values.size());
    for_pixels(film, [&](size_t i) { read_variance(film, *plane, i, image.variance.data() + i * image.channels); });
  }
  return image;
}

Features read_features(const Film& film, HalfRange halves) {
  return {film.region.width(), film.region.height(), read_feature(film, GRADUS_PASS_DENOISING_NORMAL, halves),
          read_feature(film, GRADUS_PASS_DENOISING_ALBEDO, halves),
          read_feature(film, GRADUS_PASS_DENOISING_DEPTH, halves)};
}

}  // namespace gradus::film
