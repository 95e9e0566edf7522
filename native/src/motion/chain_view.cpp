#include "motion/chain_view.h"

#include <tbb/parallel_for.h>

#include "path/context.h"

namespace gradus {

const SpecularChain* ChainView::at(int32_t x, int32_t y) const {
  if (!region().contains(x, y)) return nullptr;
  const int32_t place = places[size_t(y - region().y0) * size_t(region().width()) + size_t(x - region().x0)];
  return place < 0 ? nullptr : &chains[size_t(place)];
}

ChainView view_chains(const CentreView& centres, const GradusSettings& settings, const ComponentSet& components, int component,
                      const CancelTest& is_cancelled) {
  ChainView view{&centres, &settings, std::vector<int32_t>(centres.hits.size(), -1), {}};
  const Region& region = centres.region;
  const auto width = size_t(region.width());
  const ChainTracer tracer = view.tracer();
  std::vector<std::vector<SpecularChain>> rows(size_t(region.height()));
  tbb::parallel_for(size_t{0}, rows.size(), [&](size_t row) {
    for (size_t x = 0; x < width && !is_cancelled(); ++x) {
      const Vec2 film = pixel_centre(region.x0 + int32_t(x), region.y0 + int32_t(row));
      SpecularChain chain;
      if (!tracer.find(film, centres.hits[row * width + x], components, component, &chain)) continue;
      view.places[row * width + x] = int32_t(rows[row].size());
      rows[row].push_back(chain);
    }
  });
  for (size_t row = 0; row < rows.size(); ++row) {
    const auto first = int32_t(view.chains.size());
    for (size_t x = 0; x < width; ++x) {
      if (view.places[row * width + x] >= 0) view.places[row * width + x] += first;
    }
    view.chains.insert(view.chains.end(), rows[row].begin(), rows[row].end());
    rows[row] = {};
  }
  return view;
}

}  // namespace gradus
