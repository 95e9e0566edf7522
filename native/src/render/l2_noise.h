// What the least-squares reconstruction leaves of the noise of one sample.
//
// L2 is linear, x = S(α²I + Dᵀg) with S = (α² + DᵀD)⁻¹, and away from borders the same everywhere. A sample of a pixel
// adds v₀ to I there and v_k to the differences towards its four neighbours, so its mark on the whole picture has the
// Fourier transform Σ v_j ψ_j,
//   ψ₀ = α²/(α² + λ),  ψ_k = (e^{iu_k} − 1)/(α² + λ),  λ = 4 − 2 cos u − 2 cos v,  u_k: u, v, −u, −v
// and by Parseval the sum of squares Σ v_j v_l ⟨ψ_j ψ̄_l⟩. Samples of different pixels are independent: the mean of this
// over the deviations of samples is the mean squared error, with all correlation between a pixel and its differences.
// Nothing that stands alone is lost: v = C(1, −1, −1, −1, −1), a path whose four shifts fail, gives C².
#pragma once

#include <array>

#include "film/film.h"

namespace gradus::render {

// Mean over RGB of the products.
double mean_product(const Radiance& a, const Radiance& b);

class L2Noise {
 public:
  explicit L2Noise(double alpha);
  // Sum of squares over the picture, mean over RGB, of what these deviations become.
  double of(const Radiance& pixel, const std::array<Radiance, film::kOffsets>& differences) const;

 private:
  // ⟨ψ_j ψ̄_l⟩ by the directions of the two: the pixel is 0, two differences are the same, at right angles, or opposite.
  double pixel_ = 0.0, mixed_ = 0.0, same_ = 0.0, right_angle_ = 0.0, opposite_ = 0.0;
};

}  // namespace gradus::render
