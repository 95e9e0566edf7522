#include "output/light_pass_samples.h"

namespace gradus::output {
namespace {

reconstruct::HalfSums sums_of(const film::Channel& plane, size_t pixel) {
  reconstruct::HalfSums sums;
  for (int half = 0; half < film::kHalves; ++half) {
    const float* const v = plane.values[half].data() + 3 * pixel;
    sums[half] = Rgb(v[0], v[1], v[2]);
  }
  return sums;
}

reconstruct::HalfSums remainder_of(const film::Film& film, const LightPassPlanes& planes, const film::Channel* hidden,
                                   size_t pixel) {
  reconstruct::HalfSums remainder{Rgb(0.0f), Rgb(0.0f)};
  if (hidden != nullptr) remainder = sums_of(*hidden, pixel);
  for (int half = 0; half < film::kHalves; ++half) {
    for (const film::ComponentPlanes& component : film.components)
      remainder[half] += Rgb(component.primal[half][pixel]);
  }
  for (const film::Channel* plane : planes) {
    const reconstruct::HalfSums sums = sums_of(*plane, pixel);
    for (int half = 0; half < film::kHalves; ++half) remainder[half] -= sums[half];
  }
  return remainder;
}

}  // namespace

reconstruct::HalvedImage read_light_pass(const film::Film& film, const film::Channel& plane) {
  return reconstruct::read_halves(film, [&](size_t i) { return sums_of(plane, i); });
}

reconstruct::HalvedImage read_remainder(const film::Film& film, const LightPassPlanes& planes,
                                        const film::Channel* hidden) {
  return reconstruct::read_halves(film, [&](size_t i) { return remainder_of(film, planes, hidden, i); });
}

film::FeatureImage read_color(const film::Film& film, const film::Channel& plane) {
  film::FeatureImage color{3, std::vector<float>(3 * size_t(film.region.area())), {}};
  for (size_t i = 0; i < color.values.size(); ++i) {
    const uint32_t n = film::samples_at(film, i / 3);
    color.values[i] = n > 0 ? plane.values[0][i] / float(n) : 0.0f;
  }
  return color;
}

}  // namespace gradus::output
