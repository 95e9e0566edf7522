// Specular motion: the film position in another frame of what a component shows in a pixel through smooth surfaces
// (Zimmer et al. 2015, section 4.1). See docs/method.md, "Specular motion".
#pragma once

#include <array>
#include <vector>

#include "motion/chain_view.h"
#include "motion/film_search.h"
#include "motion/tracking.h"

namespace gradus::motion {

struct TrackingCounts {
  std::array<uint64_t, kTrackingCauses + 1> pixels{};  // pixels for each -cause; at 0 those that are tracked
  SearchCounts search;                                 // effort for the tracked pixels with smooth vertices
  uint64_t searched = 0;                               // number of these pixels

  void add(const TrackingCounts& other);
};

// Motion of the chains of a component, one value for each pixel of a region.
struct ChainMotion {
  std::vector<Vec2> film;  // film position in the other frame; the pixel's own centre if it is not tracked
  std::vector<Tracking> tracking;
  TrackingCounts counts;
};
// Motion of another view, over the same part and to the same frame. Where two views show the same directly, it need not
// be searched for again.
struct KnownMotion {
  const ChainView& view;
  const ChainMotion& motion;
};
// Number of film rows that are tracked together. The chains of all pixels would take more memory than a frame.
inline constexpr int32_t kTrackingBand = 64;
// Whether a search takes one step in time alone, or also several smaller ones where that fails. The smaller ones follow
// up to 0.5 % more points, for up to 4.4 times the rays (docs/experiments.md).
enum class SearchSteps : uint8_t { One, Several };
// Returns the motion of a part of the view `from` to the frame of `to`, which may have another time and another camera.
// After cancelling, pixels are NotConverged. known: motion of another view, or nullptr.
ChainMotion track_chains(
    const ChainView& from, const ChainTracer& to, const Region& part,
    const CancelCheck& is_cancelled = [] { return false; }, const KnownMotion* known = nullptr,
    SearchSteps steps = SearchSteps::Several);

}  // namespace gradus::motion
