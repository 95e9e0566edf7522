#include "render/component_replay.h"

#include <algorithm>

#include "path/components.h"

namespace gradus {

namespace {

bool parts(const PixelLinks& own, const PixelLinks& surface, size_t pixel) {
  return own.pixel[pixel] != kNoLink && own.pixel[pixel] != surface.pixel[pixel];
}

// The first component that goes where this one goes; itself, if none before does.
size_t first_on_the_way(const SampleSources& sources, size_t component, size_t pixel) {
  const int32_t source = sources.of_component[component].pixel[pixel];
  for (size_t c = 0; c < component; ++c) {
    const PixelLinks& other = sources.of_component[c];
    if (!other.empty() && other.pixel[pixel] == source) return c;
  }
  return component;
}

// That are sampled once more for this component.
size_t parting_pixels(const SampleSources& sources, size_t component) {
  const PixelLinks& own = sources.of_component[component];
  size_t pixels = 0;
  for (size_t i = 0; i < own.pixel.size(); ++i) {
    pixels += parts(own, sources.links, i) && first_on_the_way(sources, component, i) == component ? 1 : 0;
  }
  return pixels;
}

}  // namespace

void limit_own_ways(SampleSources* sources) {
  size_t pixels = 0;
  for (size_t c = 0; c < sources->of_component.size(); ++c) {
    const size_t parting = parting_pixels(*sources, c);
    if (pixels + parting > sources->links.pixel.size()) {
      sources->of_component[c] = {};
    } else {
      pixels += parting;
    }
  }
  const auto& all = sources->of_component;
  if (std::all_of(all.begin(), all.end(), [](const auto& own) { return own.empty(); })) sources->of_component.clear();
}

ComponentReplays replays_of_components(const SampleSources& sources) {
  ComponentReplays replays;
  const size_t pixels = sources.links.pixel.size();
  std::vector<size_t> places(sources.of_component.size());  // in replays.own
  for (size_t c = 0; c < places.size(); ++c) {
    if (!sources.has_own(int(c))) continue;
    const PixelLinks& own = sources.of_component[c];
    const SampleSources along{sources.stream_frame, own, sources.scene_key, sources.seed, sources.shares_jitter};
    places[c] = replays.own.size();
    replays.own.push_back({along, std::vector<uint8_t>(pixels, 0), std::vector<uint32_t>(pixels, 0)});
    if (replays.shared.empty()) replays.shared.assign(pixels, kEveryComponent);
    for (size_t i = 0; i < pixels; ++i) {
      if (!parts(own, sources.links, i)) continue;
      const size_t first = first_on_the_way(sources, c, i);
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

}  // namespace gradus
