#include "reconstruct/space_time/weigh_alike.h"

#include "reconstruct/solver_planes.h"

namespace gradus {

void weigh_alike(const WindowSource& source, float alpha, SpaceTimeSystem* system) {
  const WindowSize size = source.size();
  for (const RowKind kind : kRowKinds) {
    for (int t = 0; t + int(is_temporal(kind)) < size.frames; ++t) {
      if (kind == RowKind::kPrimal) system->frame(t).factor = alpha * alpha;
      for_pieces(size.height, [&](int begin, int end) {
        std::vector<float> values(size_t(size.width) * size_t(size.channels)), weights(static_cast<size_t>(size.width));
        for (int y = begin; y < end; ++y) {
          source.read_row(kind, t, y, values.data());
          for (int x = 0; x < size.width; ++x) {
            weights[size_t(x)] = is_complete(values.data() + ptrdiff_t(x) * size.channels, size.channels) ? 1.0f : 0.0f;
          }
          system->set_weights(kind, t, y, weights.data());
        }
      });
    }
  }
}

}  // namespace gradus
