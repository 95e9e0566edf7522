#include "render/part_samples.h"

#include <algorithm>
#include <array>

#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus {
namespace {

using HalfSums = std::array<Rgb, kHalves>;

HalfSums sums_of(const PassPlane& plane, size_t pixel) {
  HalfSums sums;
  for (int half = 0; half < kHalves; ++half) {
    const float* const v = plane.values[half].data() + 3 * pixel;
    sums[half] = Rgb(v[0], v[1], v[2]);
  }
  return sums;
}

HalfSums rest_of(const Frame& frame, const PartPlanes& planes, size_t pixel) {
  HalfSums rest{Rgb(0.0f), Rgb(0.0f)};
  for (int half = 0; half < kHalves; ++half) {
    for (const ComponentPlanes& component : frame.components) rest[half] += Rgb(component.primal[half][pixel]);
  }
  for (const PassPlane* plane : planes) {
    const HalfSums sums = sums_of(*plane, pixel);
    for (int half = 0; half < kHalves; ++half) rest[half] -= sums[half];
  }
  return rest;
}

void guess_noise(const Frame& frame, HalvedImage* image) {
  const auto are_missing = [](const std::vector<uint32_t>& counts) { return std::find(counts.begin(), counts.end(), 0u) != counts.end(); };
  if (!are_missing(frame.count[0]) && !are_missing(frame.count[1])) return;
  const Field around = box_mean(image->mean, 1);
  for_values(&image->half_difference, [&](float& value, int x, int y, int c) {
    if (!is_finite(value)) value = image->mean.row(y, c)[x] - around.row(y, c)[x];
  });
}

// From sums_at(pixel).
template <class SumsAt>
HalvedImage read_halves(const Frame& frame, const SumsAt& sums_at) {
  const int w = frame.region.width(), h = frame.region.height();
  HalvedImage image{Field(w, h, 3), Field(w, h, 3)};
  for_rows(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const size_t i = size_t(y) * size_t(w) + size_t(x);
      const HalfSums sums = sums_at(i);
      const auto a = float(frame.count[0][i]), b = float(frame.count[1][i]);
      for (int c = 0; c < 3; ++c) {
        const float mean = (sums[0][c] + sums[1][c]) / (a + b);
        image.mean.row(y, c)[x] = is_finite(mean) ? mean : 0.0f;
        image.half_difference.row(y, c)[x] = 0.5f * (sums[0][c] / a - sums[1][c] / b);  // not finite where a half has no samples
      }
    }
  });
  guess_noise(frame, &image);
  return image;
}

}  // namespace

HalvedImage read_part(const Frame& frame, const PassPlane& plane) {
  return read_halves(frame, [&](size_t i) { return sums_of(plane, i); });
}

HalvedImage read_rest(const Frame& frame, const PartPlanes& planes) {
  return read_halves(frame, [&](size_t i) { return rest_of(frame, planes, i); });
}

FeatureImage read_color(const Frame& frame, const PassPlane& plane) {
  FeatureImage color{3, std::vector<float>(3 * size_t(frame.region.area())), {}};
  for (size_t i = 0; i < color.values.size(); ++i) {
    const uint32_t n = samples_at(frame, i / 3);
    color.values[i] = n > 0 ? plane.values[0][i] / float(n) : 0.0f;
  }
  return color;
}

}  // namespace gradus
