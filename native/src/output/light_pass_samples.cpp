#include "output/light_pass_samples.h"

namespace gradus {
namespace {

HalfSums sums_of(const PassPlane& plane, size_t pixel) {
  HalfSums sums;
  for (int half = 0; half < kHalves; ++half) {
    const float* const v = plane.values[half].data() + 3 * pixel;
    sums[half] = Rgb(v[0], v[1], v[2]);
  }
  return sums;
}

HalfSums remainder_of(const Film& film, const LightPassPlanes& planes, size_t pixel) {
  HalfSums remainder{Rgb(0.0f), Rgb(0.0f)};
  for (int half = 0; half < kHalves; ++half) {
    for (const ComponentPlanes& component : film.components) remainder[half] += Rgb(component.primal[half][pixel]);
  }
  for (const PassPlane* plane : planes) {
    const HalfSums sums = sums_of(*plane, pixel);
    for (int half = 0; half < kHalves; ++half) remainder[half] -= sums[half];
  }
  return remainder;
}

}  // namespace

HalvedImage read_light_pass(const Film& film, const PassPlane& plane) {
  return read_halves(film, [&](size_t i) { return sums_of(plane, i); });
}

HalvedImage read_remainder(const Film& film, const LightPassPlanes& planes) {
  return read_halves(film, [&](size_t i) { return remainder_of(film, planes, i); });
}

FeatureImage read_color(const Film& film, const PassPlane& plane) {
  FeatureImage color{3, std::vector<float>(3 * size_t(film.region.area())), {}};
  for (size_t i = 0; i < color.values.size(); ++i) {
    const uint32_t n = samples_at(film, i / 3);
    color.values[i] = n > 0 ? plane.values[0][i] / float(n) : 0.0f;
  }
  return color;
}

}  // namespace gradus
