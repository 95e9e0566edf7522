#include "motion/chain_jacobian.h"

namespace gradus::motion {

namespace {

// Of a difference between two neighbours, relative to it: where it is larger the pixel lies at an edge of facets.
constexpr float kLargestBend = 0.5f;

// Central where both neighbours go the same way.
bool column(const ChainView& view, const Aim& aim, const SpecularChain& centre, const Vec3& here, glm::ivec2 at,
            glm::ivec2 by, Vec3* column) {
  std::array<Vec3, 2> difference;
  size_t count = 0;
  for (const int side : {-1, 1}) {
    const SpecularChain* neighbour = view.at(at.x + side * by.x, at.y + side * by.y);
    Vec3 there;
    if (neighbour == nullptr || neighbour->signature != centre.signature || !aim.miss(neighbour->ray.ray, &there))
      continue;
    difference[count++] = float(side) * (there - here);
  }
  if (count == 0) return false;
  *column = difference[0];
  if (count == 1) return true;
  *column = 0.5f * (difference[0] + difference[1]);
  return glm::length(difference[1] - difference[0]) < kLargestBend * glm::length(*column);
}

}  // namespace

FilmJacobian chain_jacobian(const ChainView& view, const Target& target, int32_t x, int32_t y) {
  FilmJacobian jacobian;
  const SpecularChain& chain = *view.at(x, y);
  const Aim aim(target, chain.ray.ray.origin);
  Vec3 here;
  jacobian.axis = aim.axis();
  jacobian.known = aim.miss(chain.ray.ray, &here) &&
                   column(view, aim, chain, here, {x, y}, {1, 0}, &jacobian.columns[0]) &&
                   column(view, aim, chain, here, {x, y}, {0, 1}, &jacobian.columns[1]);
  return jacobian;
}

}  // namespace gradus::motion
