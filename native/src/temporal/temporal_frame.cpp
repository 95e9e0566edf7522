#include "temporal/temporal_frame.h"

#include <numeric>
#include <string>

#include "base/error.h"
#include "temporal/pixel_links.h"

namespace gradus {

namespace {

// Whatever a folder may hold under the names of frames.
void check_alike(const Frame& frame, const GradientImages& other) {
  const bool fits = frame.region.width() == other.width && frame.region.height() == other.height && frame.channels == other.channels &&
                    frame.gradients == !other.dx.empty();
  if (!fits)
    throw invalid_argument("stored frame " + std::to_string(frame.frame_number) + " has another size or other planes than those beside it");
}

// Of a frame whose stream is `stream`, to the next one.
std::vector<int32_t> links_to(const TemporalFrame& next, const SampleSources& replayed, int32_t stream) {
  std::vector<int32_t> links(next.replay_share.size(), kNoLink);
  if (next.repeats) std::iota(links.begin(), links.end(), 0);
  const bool follows = replayed.stream_frame == stream && replayed.pixel.size() == links.size();
  return follows && !next.repeats ? inverse_links(replayed.pixel) : links;
}

}  // namespace

HalvedImages read_halved(const Frame& frame) { return {read_images(frame, 0), read_half_differences(frame, 0)}; }

TemporalFrame make_temporal_frame(const Frame& base, const Frame& replay) {
  TemporalFrame frame;
  frame.base = read_halved(base);
  check_alike(replay, frame.base.values);
  frame.replay = read_halved(replay);
  frame.replay_share.resize(base.count[0].size());
  for (size_t i = 0; i < frame.replay_share.size(); ++i) {
    const auto own = float(base.count[0][i] + base.count[1][i]), other = float(replay.count[0][i] + replay.count[1][i]);
    frame.replay_share[i] = own + other > 0.0f ? other / (own + other) : 0.0f;
  }
  return frame;
}

void for_temporal_frames(int count, const LoadPart& base, const LoadPart& replay, const TakeFrame& take) {
  std::shared_ptr<TemporalFrame> before;
  int32_t stream = 0;  // of the frame before
  for (int place = 0; place < count; ++place) {
    const std::shared_ptr<const Frame> own = base(place), other = replay(place);
    if (before) check_alike(*own, before->base.values);
    auto frame = std::make_shared<TemporalFrame>(make_temporal_frame(*own, *other));
    if (before) {
      frame->repeats = own->frame_number == stream;
      before->links = links_to(*frame, other->replayed, stream);
      take(std::move(before), frame);
    }
    stream = own->frame_number;
    before = std::move(frame);
  }
  if (before) take(std::move(before), nullptr);
}

}  // namespace gradus
