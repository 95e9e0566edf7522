#include "reconstruct/space_time/weigh_by_noise.h"

#include "reconstruct/noise_weights.h"
#include "reconstruct/solver_planes.h"

namespace gradus {
namespace {

NoiseWeights read_weights(const WindowSource& source, RowKind kind, int t) {
  const auto [w, h, channels, frames] = source.size();
  std::vector<float> deviations(size_t(w) * size_t(h));
  for_rows(h, [&, width = size_t(w)](int y) { source.read_deviations(kind, t, y, deviations.data() + size_t(y) * width); });
  return {deviations, w, h};
}

}  // namespace

void weigh_by_noise(const WindowSource& source, float scale, SpaceTimeSystem* system) {
  const WindowSize size = source.size();
  const int w = size.width, shared = std::min(size.channels, 3);
  // Pixels come first, for differences are limited by them.
  for (const RowKind kind : kRowKinds) {
    const bool of_pixels = kind == RowKind::kPrimal;
    for (int t = 0; t + int(is_temporal(kind)) < size.frames; ++t) {
      const NoiseWeights by_noise = read_weights(source, kind, t);
      for_pieces(size.height, [&](int begin, int end) {
        std::vector<float> values(size_t(w) * size_t(size.channels)), weights(static_cast<size_t>(w)), pixels(weights);
        for (int y = begin; y < end; ++y) {
          by_noise.read_row(y, scale, of_pixels ? 1.0f : kUnknownAlpha, weights.data());
          source.read_row(kind, t, y, values.data());
          if (!of_pixels) system->weights(RowKind::kPrimal, t).read_row(y, pixels.data());
          for (int x = 0; x < w; ++x) {
            float& weight = weights[size_t(x)];
            if (!is_complete(values.data() + ptrdiff_t(x) * size.channels, shared)) weight = 0.0f;
            if (!of_pixels) weight = limited_difference(weight, pixels[size_t(x)]);
          }
          system->set_weights(kind, t, y, weights.data());
        }
      });
    }
  }
  for (int t = 0; t < size.frames; ++t) system->frame(t).factor = 1.0f;
}

}  // namespace gradus
