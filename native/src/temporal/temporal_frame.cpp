#include "temporal/temporal_frame.h"

#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"
#include "frame/read_pixels.h"
#include "temporal/pixel_links.h"

namespace gradus {

namespace {

// *sum is empty before the first.
void add(GradientImages term, GradientImages* sum) {
  if (sum->primal.empty()) return static_cast<void>(*sum = std::move(term));
  for (auto plane : {&GradientImages::primal, &GradientImages::dx, &GradientImages::dy}) {
    for (size_t i = 0; i < (sum->*plane).size(); ++i) (sum->*plane)[i] += (term.*plane)[i];
  }
}

HalvedImages read_halved(const Frame& frame, TemporalContent content, int component = kAllComponents) {
  HalvedImages images;
  const bool is_one = component != kAllComponents;
  const int first = is_one ? component : 0, end = is_one ? component + 1 : int(frame.components.size());
  for (int c = first; c < end; ++c) {
    add(content.gradients ? read_images(frame, c) : read_pixels(frame, c), &images.values);
    if (!content.halves) continue;
    add(content.gradients ? read_half_differences(frame, c) : read_half_differences_of_pixels(frame, c), &images.half_differences);
  }
  return images;
}

// Of one component: where that was.
SampleSources sources_of(const SampleSources& replayed, int component) {
  SampleSources sources = replayed;
  if (component != kAllComponents && replayed.has_own(component)) sources.links = replayed.of_component[size_t(component)];
  if (component != kAllComponents) sources.of_component.clear();
  return sources;
}

}  // namespace

void check_alike(const GradientImages& images, const GradientImages& other, int32_t frame) {
  const bool fits = images.width == other.width && images.height == other.height && images.channels == other.channels &&
                    images.dx.empty() == other.dx.empty();
  if (!fits) throw invalid_argument("stored frame " + std::to_string(frame) + " has another size or other planes than those beside it");
}

TemporalFrame make_replay(const Frame& replay, int32_t stream, TemporalContent content) {
  TemporalFrame frame;
  frame.replay = read_halved(replay, content);
  frame.stream = stream;
  frame.scene_key = replay.scene_key;
  frame.replayed = replay.replayed;
  return frame;
}

TemporalFrame make_base(const Frame& base, TemporalContent content) {
  TemporalFrame frame;
  frame.base = read_halved(base, content);
  frame.stream = base.frame_number;
  frame.scene_key = base.scene_key;
  return frame;
}

TemporalFrame make_temporal_frame(const Frame& base, const Frame& replay, TemporalContent content, int component) {
  TemporalFrame frame;
  frame.replay = read_halved(replay, content, component);
  frame.base = read_halved(base, content, component);
  frame.stream = base.frame_number;
  frame.scene_key = replay.scene_key;
  frame.replayed = sources_of(replay.replayed, component);
  check_alike(frame.replay.values, frame.base.values, base.frame_number);
  frame.replay_share.resize(base.count[0].size());
  for (size_t i = 0; i < frame.replay_share.size(); ++i) {
    const auto own = float(samples_at(base, i)), other = float(samples_at(replay, i));
    frame.replay_share[i] = own + other > 0.0f ? other / (own + other) : 0.0f;
  }
  return frame;
}

PixelLinks links_between(const TemporalFrame& frame, const TemporalFrame& next) {
  const GradientImages& images = next.replay.values;
  std::vector<int32_t> pixel(size_t(images.width) * size_t(images.height), kNoLink);
  if (is_repeated(frame, next)) std::iota(pixel.begin(), pixel.end(), 0);
  const SampleSources& replayed = next.replayed;
  const bool follows = replayed.stream_frame == frame.stream && replayed.links.pixel.size() == pixel.size();
  return follows && !is_repeated(frame, next) ? inverse_links(replayed.links) : PixelLinks{std::move(pixel)};
}

}  // namespace gradus
