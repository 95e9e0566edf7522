#include "motion/irradiance_motion.h"

#include <tbb/parallel_invoke.h>

#include "motion/film_plane.h"
#include "motion/flow_vectors.h"

namespace gradus::motion {
namespace {

constexpr float kReturn = 0.1f;  // pixels: maximum error of a flow there and back (Zimmer et al. 2015, section 4.2)

// Decides whether the vector of a pixel is reliable.
class Check {
 public:
  Check(const FlowFrame& from, const FlowFrame& to, const std::vector<Vec2>& there, const std::vector<Vec2>& back)
      : from_(from), to_(to), there_(there), back_(to.plane(back)) {}

  // Returns kTracked, or the cause why the vector is not reliable.
  float cause(size_t p) const {
    if (from_.tracked()[p] != kTracked) return from_.tracked()[p] < 0.0f ? from_.tracked()[p] : kComesBackElsewhere;
    if (from_.shows_edge(p)) return kSilhouette;
    const Vec2 arrival = from_.place(p) + there_[p];
    if (!to_.holds(arrival)) return kOutsideFilm;
    const size_t q = to_.nearest(arrival);
    if (to_.shows_edge(q)) return kSilhouette;
    const bool returns = glm::length(there_[p] + linear_at(back_, arrival)) <= kReturn;
    return returns && to_.object()[q] == from_.object()[p] ? kTracked : kComesBackElsewhere;
  }

 private:
  const FlowFrame &from_, &to_;
  const std::vector<Vec2>& there_;
  const FilmPlane<Vec2> back_;
};

// Returns the vectors that pass the check, and the motion of surfaces for the other pixels.
PixelMotion checked(const FlowFrame& from, const FlowFrame& to, const std::vector<Vec2>& there,
                    const std::vector<Vec2>& back) {
  const Check check(from, to, there, back);
  PixelMotion result{from.surface(), std::vector<float>(from.count())};
  each_pixel(from.width(), from.height(), [&](int, int, size_t p) {
    result.tracked[p] = check.cause(p);
    if (result.tracked[p] == kTracked) result.vectors[p] = there[p];
  });
  return result;
}

PixelMotion without_library(const FlowFrame& frame) {
  return {frame.surface(), std::vector<float>(frame.count(), kNoFlowLibrary)};
}

}  // namespace

std::array<PixelMotion, 2> irradiance_motion(const FlowLibrary* library, int width, int height,
                                             const ComponentFrame& first, const ComponentFrame& second,
                                             FlowDomain domain) {
  const std::array<GreyImage, 2> images = flow_levels(width, height, first.radiance, second.radiance, domain);
  const FlowFrame a(images[0], first), b(images[1], second);
  if (!library) return {without_library(a), without_library(b)};
  std::vector<Vec2> there, back;
  tbb::parallel_invoke([&] { there = flow_vectors(*library, a, b); }, [&] { back = flow_vectors(*library, b, a); });
  return {checked(a, b, there, back), checked(b, a, back, there)};
}

}  // namespace gradus::motion
