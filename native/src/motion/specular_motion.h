// Specular motion: where on the film of another frame is what a component shows in a pixel (Zimmer et al. 2015,
// section 4.1). See docs/method.md, "Specular motion".
#pragma once

#include <array>
#include <vector>

#include "motion/chain_view.h"
#include "motion/film_search.h"
#include "motion/tracking.h"

namespace gradus::motion {

struct TrackingCounts {
  std::array<uint64_t, kTrackingCauses + 1> pixels{};  // by -cause; 0: tracked
  SearchCounts search;                                 // of the tracked pixels with smooth vertices
  uint64_t searched = 0;                               // those pixels

  void add(const TrackingCounts& other);
};

// By pixels of a region.
struct ChainMotion {
  std::vector<Vec2> film;  // the place in the other frame; of an untracked pixel its own centre
  std::vector<Tracking> tracking;
  TrackingCounts counts;
};
// Of a view, from the same part of it to the same frame: what others show directly, as it does, need not be looked for
// again.
struct KnownMotion {
  const ChainView& view;
  const ChainMotion& motion;
};
// Of a part of the view `from` in the frame that `to` sees, which may be at another time or by another camera.
// Cancelled: pixels are NotConverged. known: nullptr: none.
ChainMotion track_chains(
    const ChainView& from, const ChainTracer& to, const Region& part,
    const CancelCheck& is_cancelled = [] { return false; }, const KnownMotion* known = nullptr);

}  // namespace gradus::motion
