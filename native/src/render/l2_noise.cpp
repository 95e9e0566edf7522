#include "render/l2_noise.h"

#include <complex>
#include <numbers>

namespace gradus::render {
namespace {

// Steps of the numerical integration over each frequency. The integrands are smooth except for α near 0, where that
// region holds little of the spectrum.
constexpr int kSteps = 128;

}  // namespace

double mean_product(const Radiance& a, const Radiance& b) {
  return (double(a.x) * b.x + double(a.y) * b.y + double(a.z) * b.z) / 3.0;
}

L2Noise::L2Noise(double alpha) {
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const double u = 2.0 * std::numbers::pi * (i + 0.5) / kSteps, v = 2.0 * std::numbers::pi * (j + 0.5) / kSteps;
      const double solved = 1.0 / (alpha * alpha + 4.0 - 2.0 * std::cos(u) - 2.0 * std::cos(v));
      const std::complex<double> right = (std::polar(1.0, u) - 1.0) * solved, up = (std::polar(1.0, v) - 1.0) * solved;
      const double pixel = alpha * alpha * solved;
      pixel_ += pixel * pixel;
      mixed_ += pixel * right.real();
      same_ += std::norm(right);
      right_angle_ += (right * std::conj(up)).real();
      opposite_ += (right * right).real();
    }
  }
  for (double* mean : {&pixel_, &mixed_, &same_, &right_angle_, &opposite_}) *mean /= double(kSteps) * kSteps;
}

double L2Noise::of(const Radiance& pixel, const std::array<Radiance, film::kOffsets>& d) const {
  const Radiance across = d[film::kRight] + d[film::kLeft], along = d[film::kUp] + d[film::kDown];
  double sum = pixel_ * mean_product(pixel, pixel) + 2.0 * mixed_ * mean_product(pixel, across + along);
  for (const Radiance& difference : d) sum += same_ * mean_product(difference, difference);
  sum += 2.0 * right_angle_ * mean_product(across, along);
  sum += 2.0 * opposite_ * (mean_product(d[film::kRight], d[film::kLeft]) + mean_product(d[film::kUp], d[film::kDown]));
  return sum;
}

}  // namespace gradus::render
