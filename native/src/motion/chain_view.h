// The specular chains of a component through all pixel centres of a frame. They are a map from the film to what is seen
// through smooth surfaces, so that differences between neighbouring chains give its Jacobian.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "motion/film_search.h"
#include "motion/pixel_matching.h"
#include "motion/specular_chain.h"

namespace gradus::motion {

struct ChainView {
  const CentreView* centres = nullptr;
  const GradusSettings* settings = nullptr;
  std::vector<int32_t> places;  // for each pixel of the region: index in `chains`, or -1 if there is no chain
  std::vector<SpecularChain> chains;

  const Region& region() const { return centres->region; }
  // Returns the chain of a pixel, or nullptr if it has none or lies outside the region.
  const SpecularChain* at(int32_t x, int32_t y) const {
    if (!region().contains(x, y)) return nullptr;
    const int32_t place = places[size_t(y - region().y0) * size_t(region().width()) + size_t(x - region().x0)];
    return place < 0 ? nullptr : &chains[size_t(place)];
  }
  ChainTracer tracer() const { return {*centres->snapshot, centres->camera, *settings}; }
};
// Returns the views of the components whose bits are set in `wanted`, in order. `centres` and `settings` must outlive
// the views. After cancelling, chains are missing. change, non_specular_above: see ChainTracer::find().
std::vector<ChainView> view_chains(
    const CentreView& centres, const GradusSettings& settings, const lpe::ComponentSet& components, uint32_t wanted,
    const CancelCheck& is_cancelled = [] { return false; }, const Change* change = nullptr,
    float non_specular_above = 0.0f);
// Returns a view of the surfaces that the camera sees directly, of any material, and of the sky. Its chains have no
// smooth vertices.
ChainView view_surfaces(const CentreView& centres, const GradusSettings& settings, const Change* change);

// Returns how the miss of `target` by the chain of pixel x, y changes along the film. It is a finite difference between
// chains of neighbouring pixels, so that no ray is traced. The Jacobian is not known if, along one axis, no neighbour
// has the same specular signature, or if the differences on both sides disagree.
FilmJacobian chain_jacobian(const ChainView& view, const Target& target, int32_t x, int32_t y);

}  // namespace gradus::motion
