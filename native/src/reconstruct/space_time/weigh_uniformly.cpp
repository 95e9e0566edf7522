#include "reconstruct/space_time/weigh_uniformly.h"

#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {

namespace {

// Weight of a difference over time between two pixels at different positions, relative to that of a static pixel. Such
// pixels differ because φ was rounded to whole pixels, and they repeat less of the noise (docs/method.md). The
// correspondences depend on the scene only, so that L2 remains unbiased.
constexpr float kMovingWeight = 0.1f;

float correspondence_weight(int32_t target, int32_t pixel) { return target == pixel ? 1.0f : kMovingWeight; }

}  // namespace

void weigh_uniformly(const WindowSource& source, float alpha, SpaceTimeSystem* system) {
  const WindowSize size = source.size();
  for (const RowKind kind : kRowKinds) {
    for (int t = 0; t + int(is_temporal(kind)) < size.frames; ++t) {
      if (kind == RowKind::kPrimal) system->frame(t).factor = alpha * alpha;
      for_pieces(size.height, [&](int begin, int end) {
        std::vector<float> values(size_t(size.width) * size_t(size.channels)), weights(static_cast<size_t>(size.width));
        std::vector<int32_t> correspondence(static_cast<size_t>(size.width));
        for (int y = begin; y < end; ++y) {
          source.read_row(kind, t, y, values.data());
          if (is_temporal(kind)) source.read_correspondence(t, y, correspondence.data());
          for (int x = 0; x < size.width; ++x) {
            const float weight =
                is_temporal(kind) ? correspondence_weight(correspondence[size_t(x)], y * size.width + x) : 1.0f;
            weights[size_t(x)] =
                is_complete(values.data() + ptrdiff_t(x) * size.channels, size.channels) ? weight : 0.0f;
          }
          system->set_weights(kind, t, y, weights.data());
        }
      });
    }
  }
}

}  // namespace gradus::reconstruct
