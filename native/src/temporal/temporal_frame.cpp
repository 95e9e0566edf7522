#include "temporal/temporal_frame.h"

namespace gradus {

HalvedImages read_halved(const Frame& frame) { return {read_images(frame, 0), read_half_differences(frame, 0)}; }

TemporalFrame make_temporal_frame(const Frame& base, const Frame* replay) {
  TemporalFrame frame;
  frame.base = read_halved(base);
  if (replay == nullptr) return frame;
  frame.replay = read_halved(*replay);
  frame.replay_share.resize(base.count[0].size());
  for (size_t i = 0; i < frame.replay_share.size(); ++i) {
    const auto own = float(base.count[0][i] + base.count[1][i]), other = float(replay->count[0][i] + replay->count[1][i]);
    frame.replay_share[i] = own + other > 0.0f ? other / (own + other) : 0.0f;
  }
  return frame;
}

}  // namespace gradus
