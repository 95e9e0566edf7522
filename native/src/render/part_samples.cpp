#include "render/part_samples.h"

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
