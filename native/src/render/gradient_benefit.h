// Estimates the benefit of gradients: how much they reduce the error of the reconstruction, against what the offset
// paths cost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus::render {

// Number of weights α of the pixel values for which L2 is evaluated.
inline constexpr std::size_t kPilotAlphas = 3;

// Sums over pixels with two samples each. A deviation is the mean absolute difference of the two samples, so that one
// firefly does not determine the result.
struct PilotSums {
  double pixels = 0.0, brightness = 0.0, pixel_deviation = 0.0;
  double differences = 0.0, difference_deviation = 0.0;
  // Sums of roots of deviations, in which outliers count even less: of a pixel, and of what L2 makes of the pixel and
  // its differences (render/l2_noise.h).
  double pixel_root = 0.0;
  std::array<double, kPilotAlphas> l2_roots{};
  double plain_rays = 0.0, shift_rays = 0.0, shift_shadow_rays = 0.0;
  void add(const PilotSums& other, double weight);
};

// Limit of error times cost below which gradients are used. It is above 1 because a few samples miss the outliers,
// which differences also remove. (With a limit of 1, half of an image behind glass had no gradients and twice the error
// at equal time.)
inline constexpr double kPays = 1.25;

struct Benefit {
  double error = 1.0;  // error of the reconstruction over that of the noisy image at equal sample count
  bool noisy = false;  // whether there is noise to reduce
  double cost = 1.0;   // cost of a sample with differences over that of one without
  double noise = 0.0;  // squared error over squared brightness of the noisy image
  double rays = 0.0;   // rays of a sample without differences
  bool pays() const { return noisy && error * cost < kPays; }
};

// Estimates the benefit for reconstructions that weight every row by its noise. The error is at least what L2 leaves at
// its best weight.
Benefit estimate_benefit(const PilotSums& sums);
// Estimates the benefit for L2. All l2_roots are those at the weight α of the render.
Benefit estimate_benefit_for_l2(const PilotSums& sums);

// Chooses the blocks with gradients so that error times cost of the whole image is minimal; `pixels` holds the size of
// each block. (A choice for each block alone would be worse: time spent where there is little noise is missing in noisy
// blocks.) Error and cost are sums over blocks, so the blocks with the largest gain per cost come first. Chooses all or
// no blocks where that is hardly worse.
std::vector<bool> choose_blocks(const std::vector<Benefit>& blocks, const std::vector<double>& pixels);

// Returns the variance of a pixel of the least-squares reconstruction, over that of the noisy image, if the variance of
// a pixel is `ratio` times that of a difference: the mean over all frequencies of 1/(1 + ratio·D²), D² = 4 − 2 cos u −
// 2 cos v. (Thesis eq. 5.19 at the best weight; the mean is the lattice Green's function of the plane, 2/π·K(k)/(1 + 4
// ratio) with k = 4 ratio/(1 + 4 ratio).)
double reconstructed_variance(double ratio);

}  // namespace gradus::render
