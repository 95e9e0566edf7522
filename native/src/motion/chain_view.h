// The chains of a component at all pixel centres of a frame: at the same time a map from the film to what is seen
// through smooth surfaces.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "motion/pixel_matching.h"
#include "motion/specular_chain.h"

namespace gradus::motion {

struct ChainView {
  const CentreView* centres = nullptr;
  const GradusSettings* settings = nullptr;
  std::vector<int32_t> places;  // by pixels of the region: in `chains`; -1: the component has no chain there
  std::vector<SpecularChain> chains;

  const Region& region() const { return centres->region; }
  // nullptr: there is none, or the pixel is outside of the region.
  const SpecularChain* at(int32_t x, int32_t y) const {
    if (!region().contains(x, y)) return nullptr;
    const int32_t place = places[size_t(y - region().y0) * size_t(region().width()) + size_t(x - region().x0)];
    return place < 0 ? nullptr : &chains[size_t(place)];
  }
  ChainTracer tracer() const { return {*centres->snapshot, centres->camera, *settings}; }
};
// Of the components whose bits are set in `wanted`, in order. All that is given lives as long as the views. Cancelled:
// chains are missing. change: see ChainTracer::find().
std::vector<ChainView> view_chains(
    const CentreView& centres, const GradusSettings& settings, const lpe::ComponentSet& components, uint32_t wanted,
    const CancelCheck& is_cancelled = [] { return false; }, const Change* change = nullptr);
// The surfaces that the camera sees, whatever they are, and the sky.
ChainView view_surfaces(const CentreView& centres, const GradusSettings& settings, const Change* change);

}  // namespace gradus::motion
