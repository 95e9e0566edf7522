#include "motion/component_correspondence.h"

#include "motion/pixel_matching.h"

namespace gradus::motion {

film::PixelCorrespondence match_component(const film::PixelCorrespondence& surface, const Region& region,
                                          const ChainMotion& motion) {
  const size_t pixels = surface.pixel.size();
  film::PixelCorrespondence correspondence{std::vector<int32_t>(pixels, film::kNoCorrespondence),
                                           std::vector<Vec2>(pixels, Vec2(0.0f))};
  std::vector<int32_t> owner(pixels, film::kNoCorrespondence);
  std::vector<float> distances(pixels, kInfinity);
  for (size_t i = 0; i < pixels; ++i) {
    if (motion.tracking[i] != Tracking::Tracked) continue;
    const Vec2 film = motion.film[i];
    const int32_t there = pixel_at(region, film);
    if (there == film::kNoCorrespondence) continue;
    const auto next = size_t(there);
    const float distance = glm::length(film - centre_of(region, next));
    if (!(distance < distances[next])) continue;
    if (owner[next] != film::kNoCorrespondence) correspondence.pixel[size_t(owner[next])] = film::kNoCorrespondence;
    distances[next] = distance;
    owner[next] = int32_t(i);
    correspondence.pixel[i] = there;
    correspondence.off_centre[i] = off_centre(region, next, film);
  }
  for (size_t i = 0; i < pixels; ++i) {
    const int32_t there = surface.pixel[i];
    if (correspondence.pixel[i] != film::kNoCorrespondence || there == film::kNoCorrespondence ||
        owner[size_t(there)] != film::kNoCorrespondence)
      continue;
    owner[size_t(there)] = int32_t(i);
    correspondence.pixel[i] = there;
    correspondence.off_centre[i] = surface.off_centre.empty() ? Vec2(0.0f) : surface.off_centre[i];
  }
  return correspondence;
}

}  // namespace gradus::motion
