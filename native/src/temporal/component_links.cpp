#include "temporal/component_links.h"

#include "temporal/pixel_links.h"

namespace gradus {

PixelLinks link_component(const PixelLinks& surface, const Region& region, const ChainMotion& motion) {
  const size_t pixels = surface.pixel.size();
  PixelLinks links{std::vector<int32_t>(pixels, kNoLink), std::vector<Vec2>(pixels, Vec2(0.0f))};
  std::vector<int32_t> owner(pixels, kNoLink);
  std::vector<float> distances(pixels, kInfinity);
  for (size_t i = 0; i < pixels; ++i) {
    if (motion.tracking[i] != Tracking::Tracked) continue;
    const Vec2 film = motion.film[i];
    const int32_t there = pixel_at(region, film);
    if (there == kNoLink) continue;
    const auto next = size_t(there);
    const float distance = glm::length(film - centre_of(region, next));
    if (!(distance < distances[next])) continue;
    if (owner[next] != kNoLink) links.pixel[size_t(owner[next])] = kNoLink;
    distances[next] = distance;
    owner[next] = int32_t(i);
    links.pixel[i] = there;
    links.off_centre[i] = off_centre(region, next, film);
  }
  for (size_t i = 0; i < pixels; ++i) {
    const int32_t there = surface.pixel[i];
    if (links.pixel[i] != kNoLink || there == kNoLink || owner[size_t(there)] != kNoLink) continue;
    owner[size_t(there)] = int32_t(i);
    links.pixel[i] = there;
    links.off_centre[i] = surface.off_centre.empty() ? Vec2(0.0f) : surface.off_centre[i];
  }
  return links;
}

}  // namespace gradus
