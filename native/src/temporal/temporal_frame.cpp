#include "temporal/temporal_frame.h"

#include <numeric>

#include "temporal/pixel_links.h"

namespace gradus {

HalvedImages read_halved(const Frame& frame) { return {read_images(frame, 0), read_half_differences(frame, 0)}; }

TemporalFrame make_temporal_frame(const Frame& base, const Frame& replay) {
  TemporalFrame frame;
  frame.base = read_halved(base);
  frame.replay = read_halved(replay);
  frame.replay_share.resize(base.count[0].size());
  for (size_t i = 0; i < frame.replay_share.size(); ++i) {
    const auto own = float(base.count[0][i] + base.count[1][i]), other = float(replay.count[0][i] + replay.count[1][i]);
    frame.replay_share[i] = own + other > 0.0f ? other / (own + other) : 0.0f;
  }
  return frame;
}

std::vector<std::shared_ptr<const TemporalFrame>> make_temporal_frames(int count, const LoadPart& base, const LoadPart& replay) {
  std::vector<std::shared_ptr<const TemporalFrame>> frames;
  std::shared_ptr<TemporalFrame> before;
  int32_t stream = 0;  // of the frame before
  for (int place = 0; place < count; ++place) {
    const std::shared_ptr<const Frame> own = base(place), other = replay(place);
    auto frame = std::make_shared<TemporalFrame>(make_temporal_frame(*own, *other));
    if (before) {
      frame->repeats = own->frame_number == stream;
      std::vector<int32_t>& links = before->links;
      if (frame->repeats) {
        links.resize(frame->replay_share.size());
        std::iota(links.begin(), links.end(), 0);
      } else if (other->replayed.stream_frame == stream) {
        links = inverse_links(other->replayed.pixel);
      } else {  // it was sampled after another one
        links.assign(frame->replay_share.size(), kNoLink);
      }
    }
    stream = own->frame_number;
    before = frame;
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace gradus
