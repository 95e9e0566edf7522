#include "render/component_replay.h"

#include <algorithm>

#include "path/components.h"

namespace gradus {

namespace {

bool parts(const PixelLinks& own, const PixelLinks& surface, size_t pixel) {
  return own.pixel[pixel] != kNoLink && own.pixel[pixel] != surface.pixel[pixel];
}

size_t parting_pixels(const PixelLinks& own, const PixelLinks& surface) {
  size_t pixels = 0;
  for (size_t i = 0; i < own.pixel.size(); ++i) pixels += parts(own, surface, i) ? 1 : 0;
  return pixels;
}

}  // namespace

void limit_own_ways(SampleSources* sources) {
  size_t pixels = 0;
  for (PixelLinks& own : sources->of_component) {
    const size_t parting = parting_pixels(own, sources->links);
    if (pixels + parting > sources->links.pixel.size()) {
      own = {};
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
  for (size_t c = 0; c < sources.of_component.size(); ++c) {
    if (!sources.has_own(int(c))) continue;
    const PixelLinks& own = sources.of_component[c];
    const SampleSources along{sources.stream_frame, own, sources.scene_key, sources.seed, sources.shares_jitter};
    ComponentReplay replay{uint32_t(c), along, std::vector<uint8_t>(pixels, 0)};
    if (replays.shared.empty()) replays.shared.assign(pixels, kEveryComponent);
    for (size_t i = 0; i < pixels; ++i) {
      if (!parts(own, sources.links, i)) continue;
      replay.pixels[i] = 1;
      replays.shared[i] &= ~(uint32_t{1} << c);
      ++replays.pixels;
    }
    replays.own.push_back(std::move(replay));
  }
  return replays;
}

}  // namespace gradus
