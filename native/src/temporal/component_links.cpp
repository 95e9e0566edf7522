#include "temporal/component_links.h"

#include <algorithm>

#include "temporal/pixel_links.h"

namespace gradus {

namespace {

// Behind smooth surfaces. A chain without any is the surface itself.
bool is_seen_through(const ChainView& view, size_t pixel) {
  const int32_t place = view.places[pixel];
  return place >= 0 && view.chains[size_t(place)].way.length > 0;
}

}  // namespace

bool shows_through(const ChainView& view) {
  return std::any_of(view.chains.begin(), view.chains.end(), [](const SpecularChain& chain) { return chain.way.length > 0; });
}

std::vector<int32_t> link_component(const std::vector<int32_t>& surface, const ChainView& from, const ChainMotion& motion) {
  const Region& region = from.region();
  std::vector<int32_t> links(surface.size(), kNoLink), owner(surface.size(), kNoLink);
  std::vector<float> distances(surface.size(), kInfinity);
  for (size_t i = 0; i < surface.size(); ++i) {
    if (!is_seen_through(from, i) || motion.tracking[i] != Tracking::Tracked) continue;
    const Vec2 film = motion.film[i];
    const int32_t there = pixel_at(region, film);
    if (there == kNoLink) continue;
    const auto next = size_t(there);
    const float distance = glm::length(film - centre_of(region, next));
    if (!(distance < distances[next])) continue;
    if (owner[next] != kNoLink) links[size_t(owner[next])] = kNoLink;
    distances[next] = distance;
    owner[next] = int32_t(i);
    links[i] = there;
  }
  for (size_t i = 0; i < surface.size(); ++i) {
    if (links[i] != kNoLink || surface[i] == kNoLink || owner[size_t(surface[i])] != kNoLink) continue;
    owner[size_t(surface[i])] = int32_t(i);
    links[i] = surface[i];
  }
  return links;
}

}  // namespace gradus
