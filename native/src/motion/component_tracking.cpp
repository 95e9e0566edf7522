#include "motion/component_tracking.h"

#include <algorithm>
#include <bit>

namespace gradus::motion {

namespace {

// Rows that are followed together: chains of all pixels would take more memory than a frame.
constexpr int32_t kBand = 64;

// Rows [y0, y1) of a view.
CentreView rows_of(const CentreView& view, int32_t y0, int32_t y1) {
  const auto place = [&](int32_t y) { return ptrdiff_t(y - view.region.y0) * view.region.width(); };
  const auto cut = [&](const auto& list) {
    return std::decay_t<decltype(list)>(list.begin() + place(y0), list.begin() + place(y1));
  };
  return {view.snapshot, view.camera, {view.region.x0, y0, view.region.x1, y1}, cut(view.hits), cut(view.directions)};
}

void exclude_directly_seen(ChainView* view) {
  for (int32_t& place : view->places) {
    if (place >= 0 && view->chains[size_t(place)].signature.length == 0) place = -1;
  }
}

void append(const ChainMotion& rows, ChainMotion* motion) {
  motion->film.insert(motion->film.end(), rows.film.begin(), rows.film.end());
  motion->tracking.insert(motion->tracking.end(), rows.tracking.begin(), rows.tracking.end());
  motion->counts.add(rows.counts);
}

}  // namespace

std::vector<ChainMotion> track_components(const CentreView& from, const ChainTracer& to,
                                          const lpe::ComponentSet& components, uint32_t wanted,
                                          const CancelCheck& is_cancelled) {
  Change change(*from.snapshot);
  change.add(to.snapshot());
  const Region& film = from.region;
  std::vector<ChainMotion> motion(size_t(std::popcount(wanted)));
  for (int32_t y = film.y0; y < film.y1; y += kBand) {
    const Region band{film.x0, y, film.x1, std::min(y + kBand, film.y1)};
    // With the rows around, whose chains tell how things change along the film.
    const CentreView rows = rows_of(from, std::max(y - 1, film.y0), std::min(band.y1 + 1, film.y1));
    std::vector<ChainView> views = view_chains(rows, to.settings(), components, wanted, is_cancelled, &change);
    for (size_t k = 0; k < views.size(); ++k) {
      exclude_directly_seen(&views[k]);
      append(track_chains(views[k], to, band, is_cancelled), &motion[k]);
    }
  }
  return motion;
}

bool is_seen_through_smooth(const ChainMotion& motion) {
  return std::any_of(motion.tracking.begin(), motion.tracking.end(), [](Tracking t) { return t != Tracking::NoPath; });
}

}  // namespace gradus::motion
