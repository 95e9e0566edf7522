#include "reconstruct/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/rows.h"
#include "reconstruct/chosen_alpha.h"
#include "reconstruct/poisson/minimise_by_noise.h"
#include "reconstruct/poisson/solver.h"
#include "reconstruct/poisson/twicing.h"

namespace gradus::reconstruct {
namespace {

constexpr double kMinErrorShare = 0.25;
// Standard deviations of the Gaussian windows in pixels: of 0.7 to 6, those under which the true errors are most likely
// (measured on twelve scenes). The difference of two estimates needs a larger window.
constexpr double kSigma = 1.5, kSigmaOfDifference = 2.0;
// Limit of a square, so that sums of several remain finite.
constexpr double kLargest = 1e37;

// Goal and maximum number of steps of remaining_noise(): an error estimate needs no higher accuracy.
constexpr CgGoal kGoal{.residual = 1e-2f, .row_error = 0.1f};
constexpr int kMaxSteps = 10;

// One value for each pixel.
using Plane = std::vector<float>;

Plane squares_of(const std::vector<float>& image, int width, int height, int channels) {
  Plane squares(size_t(width) * size_t(height));
  for_rows(height, [&](int y) {
    for (size_t i = size_t(y) * size_t(width); i < size_t(y + 1) * size_t(width); ++i) {
      const double square = mean_square(&image[i * size_t(channels)]);
      squares[i] = static_cast<float>(square < kLargest ? square : kLargest);  // also replaces NaN
    }
  });
  return squares;
}

class Window {
 public:
  explicit Window(double sigma) : radius_(int(std::ceil(3.0 * sigma))) {
    for (int i = 0; i <= radius_; ++i) weights_.push_back(float(std::exp(-0.5 * i * i / (sigma * sigma))));
  }

  // Replaces each value by the weighted mean over the window around it, as far as that lies in the image.
  void blur(Plane* plane, int width, int height) const {
    Plane between(plane->size());
    for_rows(height,
             [&](int y) { blur_row(plane->data() + size_t(y) * width, width, between.data() + size_t(y) * width); });
    for_rows(height, [&](int y) { blur_column(between.data(), width, height, y, plane->data() + size_t(y) * width); });
  }

 private:
  void blur_row(const float* from, int width, float* to) const {
    for (int x = 0; x < width; ++x) {
      float sum = 0.0f, weights = 0.0f;
      for (int i = std::max(x - radius_, 0); i <= std::min(x + radius_, width - 1); ++i) {
        const float weight = weights_[size_t(std::abs(i - x))];
        sum += weight * from[i];
        weights += weight;
      }
      to[x] = sum / weights;
    }
  }

  void blur_column(const float* from, int width, int height, int y, float* to) const {
    std::fill_n(to, width, 0.0f);
    float weights = 0.0f;
    for (int j = std::max(y - radius_, 0); j <= std::min(y + radius_, height - 1); ++j)
      weights += weights_[size_t(std::abs(j - y))];
    for (int j = std::max(y - radius_, 0); j <= std::min(y + radius_, height - 1); ++j) {
      const float weight = weights_[size_t(std::abs(j - y))] / weights, *row = from + size_t(j) * width;
      for (int x = 0; x < width; ++x) to[x] += weight * row[x];
    }
  }

  int radius_;
  std::vector<float> weights_;  // by distance
};

}  // namespace

ErrorTerms error_terms(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                       const std::vector<float>& image, const CancelCheck& cancel) {
  film::GradientImages differences = GRADUS_FAULT(l2_error_computed_from_image)
                                         ? film::read_images(film, component)
                                         : film::read_half_differences(film, component);
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) return {std::move(differences.primal), {}};
  SolveReport report;
  ErrorTerms terms{reconstruct(differences, GRADUS_RECONSTRUCTION_L2, alpha, cancel, &report), {}};
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) return terms;
  differences = {};
  terms.l2_difference = reconstruct(film, component, GRADUS_RECONSTRUCTION_L2, alpha, cancel, &report);
  for (size_t i = 0; i < terms.l2_difference.size(); ++i) terms.l2_difference[i] = image[i] - terms.l2_difference[i];
  return terms;
}

double squared_error(double noise, double l2_difference) {
  return std::max(noise - l2_difference, kMinErrorShare * noise);
}

std::vector<float> error_of_pixels(const ErrorTerms& terms, int width, int height, int channels) {
  const Window window(terms.l2_difference.empty() ? kSigma : kSigmaOfDifference);
  Plane error = squares_of(terms.noise, width, height, channels);
  window.blur(&error, width, height);
  if (terms.l2_difference.empty()) return error;
  Plane l2_difference = squares_of(terms.l2_difference, width, height, channels);
  window.blur(&l2_difference, width, height);
  for (size_t i = 0; i < error.size(); ++i) error[i] = static_cast<float>(squared_error(error[i], l2_difference[i]));
  return error;
}

double mean_square(const float* pixel) {
  return (double(pixel[0]) * pixel[0] + double(pixel[1]) * pixel[1] + double(pixel[2]) * pixel[2]) / 3.0;
}

RemainingNoise remaining_noise(const film::GradientImages& images, const film::GradientImages& half_differences,
                               float alpha, const CancelCheck& cancel) {
  alpha = chosen_alpha(GRADUS_RECONSTRUCTION_L1, alpha);
  SolveReport report;
  Minimum minimum = minimise_by_noise(images, cancel, &report);
  const int channels = minimum.solution.channels();
  Field noise(images.width, images.height, channels);
  minimum.system.solve(load_planes(planes_of(half_differences, 0), images.width, images.height, channels), kGoal,
                       kMaxSteps, cancel, &noise);
  const Twicing twicing(images, minimum.solution, alpha);
  const size_t stride = size_t(images.channels);
  RemainingNoise left{std::vector<float>(images.primal.size()), std::vector<float>(images.primal.size())};
  for (int c = 0; c < channels; ++c) {
    store_channel(minimum.solution, c, stride, left.image.data() + c);
    twicing.apply(planes_of(images, c), left.image.data() + c);
    store_channel(noise, c, stride, left.noise.data() + c);
    twicing.apply(planes_of(half_differences, c), left.noise.data() + c);
  }
  return left;
}

}  // namespace gradus::reconstruct
