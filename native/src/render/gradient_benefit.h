// What gradients are worth: how much less error the reconstruction has, against what the differences cost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus::render {

// Weights of the pixel at which L2 is looked at.
inline constexpr std::size_t kPilotAlphas = 3;

// What a few samples have shown, of which each pixel takes two. Deviations: between the two, as the mean of their
// absolute differences, so that one firefly does not decide.
struct PilotSums {
  double pixels = 0.0, brightness = 0.0, pixel_deviation = 0.0;
  double differences = 0.0, difference_deviation = 0.0;
  // Roots of deviations, for which outliers count less still: of a pixel, and of what L2 makes of it and its
  // differences (render/l2_noise.h).
  double pixel_root = 0.0;
  std::array<double, kPilotAlphas> l2_roots{};
  double plain_rays = 0.0, shift_rays = 0.0, shift_shadow_rays = 0.0;
  void add(const PilotSums& other, double weight);
};

// In doubt yes: a few samples miss the outliers, which differences take away, too. (With 1 half of a picture behind
// glass went without, which had twice the error at equal time.)
inline constexpr double kPays = 1.25;

struct Benefit {
  double error = 1.0;  // of the reconstruction, over that of the noisy image at the same number of samples
  bool noisy = false;  // or there is nothing to gain
  double cost = 1.0;   // of a sample with differences, over that of one without
  double noise = 0.0;  // of the noisy image: squared error over squared brightness
  double rays = 0.0;   // of a sample without differences
  bool pays() const { return noisy && error * cost < kPays; }
};

// For reconstructions that go by the noise of every row: no better than what L2 leaves at its best weight.
Benefit estimate_benefit(const PilotSums& sums);
// For L2; all l2_roots are those at its weight.
Benefit estimate_benefit_for_l2(const PilotSums& sums);

// The parts of a picture, of so many pixels each, that are to have differences for error times cost of the picture to
// be least. (Each part by itself will not do: time spent where there is little noise is time that the noisy parts go
// without.) Both are sums over parts, so one takes those first that gain most for their cost. All or none, where that
// is hardly worse.
std::vector<bool> choose_blocks(const std::vector<Benefit>& blocks, const std::vector<double>& pixels);

// Variance of the least-squares reconstruction of a pixel, over the noisy image's, where a pixel's variance is `ratio`
// times that of a difference: the mean over all frequencies of 1/(1 + ratio·D²), D² = 4 − 2 cos u − 2 cos v. (Thesis
// eq. 5.19 at the best weight; the mean is the lattice Green's function of the plane, 2/π·K(k)/(1 + 4 ratio) with k = 4
// ratio/(1 + 4 ratio).)
double reconstructed_variance(double ratio);

}  // namespace gradus::render
