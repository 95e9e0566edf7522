#include "output/certain_alpha.h"

#include <algorithm>
#include <cmath>

#include "base/rows.h"

namespace gradus::output {
namespace {

constexpr float kRounding = 1e-5f;  // of sums of alpha, relative to the number of samples

CertainAlpha alpha_of_samples(const film::Film& film, size_t pixel) {
  const auto samples = float(film::samples_at(film, pixel));
  float sum = 0.0f;
  for (const film::ComponentPlanes& component : film.components)
    sum += component.primal[0][pixel].w + component.primal[1][pixel].w;
  if (!(samples > 0.0f)) return CertainAlpha::None;
  if (std::fabs(sum) <= kRounding * samples) return CertainAlpha::Empty;
  return std::fabs(sum - samples) <= kRounding * samples ? CertainAlpha::Opaque : CertainAlpha::None;
}

// Returns the value that all 3×3 pixels around one have, or None.
CertainAlpha common_value(const std::vector<CertainAlpha>& pixels, int w, int h, int x, int y) {
  const CertainAlpha own = pixels[size_t(y) * size_t(w) + size_t(x)];
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w - 1); ++i) {
      if (pixels[size_t(j) * size_t(w) + size_t(i)] != own) return CertainAlpha::None;
    }
  }
  return own;
}

}  // namespace

std::vector<CertainAlpha> find_certain_alpha(const film::Film& film) {
  const int w = film.region.width(), h = film.region.height();
  std::vector<CertainAlpha> of_samples(size_t(film.region.area())), certain(of_samples.size());
  const auto fill = [&](std::vector<CertainAlpha>* to, const auto& value) {
    for_rows(h, [&](int y) {
      for (int x = 0; x < w; ++x) (*to)[size_t(y) * size_t(w) + size_t(x)] = value(x, y);
    });
  };
  fill(&of_samples, [&](int x, int y) { return alpha_of_samples(film, size_t(y) * size_t(w) + size_t(x)); });
  fill(&certain, [&](int x, int y) { return common_value(of_samples, w, h, x, y); });
  return certain;
}

}  // namespace gradus::output
