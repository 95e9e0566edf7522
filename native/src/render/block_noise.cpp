#include "render/block_noise.h"

#include <algorithm>
#include <cmath>

#include "base/rows.h"
#include "reconstruct/error_estimate.h"
#include "reconstruct/reconstruct_film.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solve_report.h"

namespace gradus::render {
namespace {

// Keeps the relative error of black areas finite. Unit: squared radiance at display exposure; the same constant as in
// the error measures.
constexpr double kEpsilon = 1e-3;

// The image and its estimated noise, summed over all components.
struct FilmNoise {
  std::vector<float> image;  // the reconstructed image
  reconstruct::ErrorTerms terms;
  std::vector<float> by_its_weights;  // noise by the measured weights of L1; empty for other reconstructions
  std::vector<float> error;           // squared error by pixel, if the reconstruction estimates it; replaces `terms`
};

void add_terms(const film::Film& film, int component, uint32_t reconstruction, float alpha,
               const std::vector<float>& image, const CancelCheck& cancel, FilmNoise* sum) {
  reconstruct::ErrorTerms terms = reconstruct::error_terms(film, component, reconstruction, alpha, image, cancel);
  reconstruct::add_image(std::move(terms.noise), &sum->terms.noise);
  reconstruct::add_image(std::move(terms.l2_difference), &sum->terms.l2_difference);
}

// Adds a component whose reconstruction is L1. Estimates its noise by weights of the measured noise, which are close to
// the weights of L1 and need no iteration.
void add_l1(const film::Film& film, int component, uint32_t reconstruction, float alpha, const CancelCheck& cancel,
            FilmNoise* sum) {
  film::GradientImages images = film::read_images(film, component);
  film::read_deviations(film, component, &images);
  reconstruct::RemainingNoise left =
      reconstruct::remaining_noise(images, film::read_half_differences(film, component), alpha, cancel);
  images = {};
  add_terms(film, component, reconstruction, alpha, left.image, cancel, sum);
  reconstruct::add_image(std::move(left.image), &sum->image);
  reconstruct::add_image(std::move(left.noise), &sum->by_its_weights);
}

// Adds a component whose reconstruction is L2 or NONE.
void add_other(const film::Film& film, int component, uint32_t reconstruction, float alpha, const CancelCheck& cancel,
               FilmNoise* sum) {
  reconstruct::SolveReport report;
  std::vector<float> image =
      reconstruct::reconstruct_component(film, component, reconstruction, alpha, cancel, &report);
  add_terms(film, component, reconstruction, alpha, image, cancel, sum);
  reconstruct::add_image(std::move(image), &sum->image);
}

FilmNoise noise_of(const film::Film& film, uint32_t reconstruction, float alpha, const CancelCheck& cancel) {
  FilmNoise sum;
  if (reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    reconstruct::SolveReport report;
    reconstruct::Reconstructed picture = reconstruct::regularize(film, false, cancel, &report);
    sum.image = std::move(picture.image);
    sum.error = std::move(picture.error);
    return sum;
  }
  const auto add_component = reconstruction == GRADUS_RECONSTRUCTION_L1 ? add_l1 : add_other;
  for (int component = 0; component < int(film.components.size()); ++component) {
    add_component(film, component, reconstruction, alpha, cancel, &sum);
  }
  return sum;
}

// Returns the mean over RGB.
double gray(const float* pixel) { return (double(pixel[0]) + pixel[1] + pixel[2]) / 3.0; }

// Squared noise of a pixel.
struct PixelNoise {
  double noise = 0.0, l2_difference = 0.0;  // the two arguments of squared_error()
  double own = 0.0;                         // by the weights of the reconstruction
};

// Returns the squared noise of pixel `i`, whose first channel value has the index `v`.
PixelNoise noise_of_pixel(const FilmNoise& images, size_t i, size_t v) {
  PixelNoise pixel;
  pixel.noise = images.error.empty() ? reconstruct::mean_square(&images.terms.noise[v]) : double(images.error[i]);
  if (!images.terms.l2_difference.empty())
    pixel.l2_difference = reconstruct::mean_square(&images.terms.l2_difference[v]);
  pixel.own = images.by_its_weights.empty() ? pixel.noise : reconstruct::mean_square(&images.by_its_weights[v]);
  return pixel;
}

BlockNoise noise_of_block(const film::Film& film, const FilmNoise& images, const Region& block) {
  const double exposure = double(film.settings.film_exposure) * film.settings.film_exposure;
  double noise = 0.0, l2_difference = 0.0, signal = 0.0, relative = 0.0;
  for (int32_t y = block.y0; y < block.y1; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) {
      const size_t i = film.index(x, y), v = i * size_t(film.color_channels);
      const PixelNoise pixel = noise_of_pixel(images, i, v);
      const double g = gray(&images.image[v]), s = exposure * g * g + kEpsilon;
      noise += exposure * pixel.noise;
      l2_difference += exposure * pixel.l2_difference;
      signal += s;
      relative += exposure * pixel.own / s;
    }
  }
  return {std::sqrt(reconstruct::squared_error(noise, l2_difference) / signal),
          std::sqrt(relative / double(block.area()))};
}

}  // namespace

std::vector<BlockNoise> estimate_noise(const film::Film& film, const std::vector<Region>& blocks,
                                       uint32_t reconstruction, float alpha, const CancelCheck& cancel) {
  const FilmNoise images = noise_of(film, reconstruction, alpha, cancel);
  std::vector<BlockNoise> result(blocks.size());
  for_rows(int(blocks.size()), [&](int i) { result[size_t(i)] = noise_of_block(film, images, blocks[size_t(i)]); });
  return result;
}

}  // namespace gradus::render
