#include "render/component_replay.h"

#include <algorithm>

#include "lpe/components.h"

namespace gradus::render {

namespace {

// Returns whether the component has a source pixel that differs from that of the surface.
bool parts(const film::PixelCorrespondence& own, const film::PixelCorrespondence& surface, size_t pixel) {
  return own.pixel[pixel] != film::kNoCorrespondence && own.pixel[pixel] != surface.pixel[pixel];
}

// Returns the first component with the same source pixel as this one; `component` itself if no earlier one has it.
size_t first_with_same_replay(const film::ReplayMap& replay_map, size_t component, size_t pixel) {
  const int32_t source = replay_map.of_component[component].pixel[pixel];
  for (size_t c = 0; c < component; ++c) {
    const film::PixelCorrespondence& other = replay_map.of_component[c];
    if (!other.empty() && other.pixel[pixel] == source) return c;
  }
  return component;
}

// Returns the number of pixels that are sampled additionally for this component.
size_t parting_pixels(const film::ReplayMap& replay_map, size_t component) {
  const film::PixelCorrespondence& own = replay_map.of_component[component];
  size_t pixels = 0;
  for (size_t i = 0; i < own.pixel.size(); ++i) {
    pixels += parts(own, replay_map.correspondence, i) && first_with_same_replay(replay_map, component, i) == component
                  ? 1
                  : 0;
  }
  return pixels;
}

}  // namespace

void limit_component_replays(film::ReplayMap* replay_map) {
  size_t pixels = 0;
  for (size_t c = 0; c < replay_map->of_component.size(); ++c) {
    const size_t parting = parting_pixels(*replay_map, c);
    if (pixels + parting > replay_map->correspondence.pixel.size()) {
      replay_map->of_component[c] = {};
    } else {
      pixels += parting;
    }
  }
  const auto& all = replay_map->of_component;
  if (std::all_of(all.begin(), all.end(), [](const auto& own) { return own.empty(); }))
    replay_map->of_component.clear();
}

ComponentReplays replays_of_components(const film::ReplayMap& replay_map) {
  ComponentReplays replays;
  const size_t pixels = replay_map.correspondence.pixel.size();
  std::vector<size_t> places(replay_map.of_component.size());  // by component: index in replays.own
  for (size_t c = 0; c < places.size(); ++c) {
    if (!replay_map.has_component_map(int(c))) continue;
    const film::PixelCorrespondence& own = replay_map.of_component[c];
    const film::ReplayMap along{replay_map.stream_frame,  own,
                                replay_map.scene_key,     replay_map.seed,
                                replay_map.shares_jitter, replay_map.net_samples};
    places[c] = replays.own.size();
    replays.own.push_back({along, std::vector<uint8_t>(pixels, 0), std::vector<uint32_t>(pixels, 0)});
    if (replays.shared.empty()) replays.shared.assign(pixels, lpe::kEveryComponent);
    for (size_t i = 0; i < pixels; ++i) {
      if (!parts(own, replay_map.correspondence, i)) continue;
      const size_t first = first_with_same_replay(replay_map, c, i);
      ComponentReplay& replay = replays.own[places[first]];
      replay.pixels[i] = 1;
      replay.components[i] |= uint32_t{1} << c;
      replays.shared[i] &= ~(uint32_t{1} << c);
      replays.pixels += first == c ? 1 : 0;
    }
  }
  std::erase_if(replays.own, [](const ComponentReplay& replay) {
    return std::all_of(replay.pixels.begin(), replay.pixels.end(), [](uint8_t sampled) { return sampled == 0; });
  });
  return replays;
}

}  // namespace gradus::render
