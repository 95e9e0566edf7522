// Computes the noise that the least-squares reconstruction leaves of one sample.
//
// L2 is linear, x = S(α²I + Dᵀg) with S = (α² + DᵀD)⁻¹, and shift-invariant away from borders. A sample of a pixel adds
// v₀ to I there and v_k to the differences towards its four neighbours, so its contribution to the image has the
// Fourier transform Σ v_j ψ_j,
//   ψ₀ = α²/(α² + λ),  ψ_k = (e^{iu_k} − 1)/(α² + λ),  λ = 4 − 2 cos u − 2 cos v,  u_k: u, v, −u, −v
// and by Parseval's theorem the sum of squares Σ v_j v_l ⟨ψ_j ψ̄_l⟩. Samples of different pixels are taken as
// independent: the mean of this sum over the deviations of samples is the mean squared error, with all correlation
// between a pixel and its differences. An unpaired sample keeps all its noise: v = C(1, −1, −1, −1, −1), a path whose
// four shifts fail, gives C².
#pragma once

#include <array>

#include "film/film.h"

namespace gradus::render {

// Returns the mean over RGB of the products of the two colours.
double mean_product(const Radiance& a, const Radiance& b);

class L2Noise {
 public:
  explicit L2Noise(double alpha);
  // Returns the sum of squares over the image, mean over RGB, that L2 makes of these deviations of one sample.
  double of(const Radiance& pixel, const std::array<Radiance, film::kOffsets>& differences) const;

 private:
  // The means ⟨ψ_j ψ̄_l⟩, by the pair of j and l: both the pixel, the pixel and a difference, the same difference, two
  // differences at right angles, two opposite differences.
  double pixel_ = 0.0, mixed_ = 0.0, same_ = 0.0, right_angle_ = 0.0, opposite_ = 0.0;
};

}  // namespace gradus::render
