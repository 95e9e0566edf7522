#include "animation/temporal_frame.h"

#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/fault.h"
#include "film/film.h"
#include "motion/pixel_matching.h"

namespace gradus::animation {

namespace {

// Adds the planes of `term` to those of *sum, which is empty before the first term.
void add(film::GradientImages term, film::GradientImages* sum) {
  if (sum->primal.empty()) return static_cast<void>(*sum = std::move(term));
  for (auto plane : {&film::GradientImages::primal, &film::GradientImages::dx, &film::GradientImages::dy}) {
    for (size_t i = 0; i < (sum->*plane).size(); ++i) (sum->*plane)[i] += (term.*plane)[i];
  }
}

// Reads the images of one component, or the sum of the images of all components.
HalvedImages read_halved(const film::Film& film, TemporalContent content, int component = kAllComponents) {
  HalvedImages images;
  const bool is_one = component != kAllComponents;
  const int first = is_one ? component : 0, end = is_one ? component + 1 : int(film.components.size());
  for (int c = first; c < end; ++c) {
    add(content.gradients ? film::read_images(film, c) : film::read_pixels(film, c), &images.values);
    if (!content.halves) continue;
    add(content.gradients ? film::read_half_differences(film, c) : film::read_half_differences_of_pixels(film, c),
        &images.half_differences);
  }
  return images;
}

// Returns the replay map of a component: its own if it has one, otherwise that of the surfaces.
film::ReplayMap replay_map_of(const film::ReplayMap& replayed, int component) {
  film::ReplayMap replay_map = replayed;
  if (component != kAllComponents && replayed.has_component_map(component))
    replay_map.correspondence = replayed.of_component[size_t(component)];
  if (component != kAllComponents) replay_map.of_component.clear();
  return replay_map;
}

}  // namespace

void check_same_layout(const film::GradientImages& images, const film::GradientImages& other, int32_t frame) {
  const bool fits = images.width == other.width && images.height == other.height && images.channels == other.channels &&
                    images.dx.empty() == other.dx.empty();
  if (!fits)
    throw invalid_argument("stored frame " + std::to_string(frame) +
                           " has another size or other planes than those beside it");
}

TemporalFrame make_replay(const film::Film& replay, int32_t stream, TemporalContent content) {
  TemporalFrame frame;
  frame.replay = read_halved(replay, content);
  frame.stream = stream;
  frame.scene_key = replay.scene_key;
  frame.replayed = replay.replayed;
  return frame;
}

TemporalFrame make_fresh(const film::Film& fresh, TemporalContent content) {
  TemporalFrame frame;
  frame.fresh = read_halved(fresh, content);
  frame.stream = fresh.frame_number;
  frame.scene_key = fresh.scene_key;
  return frame;
}

TemporalFrame make_temporal_frame(const film::Film& fresh, const film::Film& replay, TemporalContent content,
                                  int component) {
  TemporalFrame frame;
  frame.replay = read_halved(replay, content, component);
  frame.fresh = read_halved(fresh, content, component);
  frame.stream = fresh.frame_number;
  frame.scene_key = replay.scene_key;
  frame.replayed = replay_map_of(replay.replayed, component);
  check_same_layout(frame.replay.values, frame.fresh.values, fresh.frame_number);
  frame.replay_share.resize(fresh.count[0].size());
  for (size_t i = 0; i < frame.replay_share.size(); ++i) {
    const auto own = float(film::samples_at(fresh, i)), other = float(film::samples_at(replay, i));
    frame.replay_share[i] = own + other > 0.0f ? other / (own + other) : 0.0f;
    if (GRADUS_FAULT(fresh_and_replayed_share_equally)) frame.replay_share[i] = 0.5f;
  }
  return frame;
}

film::PixelCorrespondence correspondence_between(const TemporalFrame& frame, const TemporalFrame& next) {
  const film::GradientImages& images = next.replay.values;
  std::vector<int32_t> pixel(size_t(images.width) * size_t(images.height), film::kNoCorrespondence);
  if (is_repeated(frame, next)) std::iota(pixel.begin(), pixel.end(), 0);
  const film::ReplayMap& replayed = next.replayed;
  const bool follows = replayed.stream_frame == frame.stream && replayed.correspondence.pixel.size() == pixel.size();
  if (!follows || is_repeated(frame, next)) return film::PixelCorrespondence{std::move(pixel)};
  return GRADUS_FAULT(correspondence_not_inverted) ? replayed.correspondence
                                                   : motion::inverse_correspondence(replayed.correspondence);
}

}  // namespace gradus::animation
