#include "motion/chain_view.h"

#include <tbb/parallel_for.h>

#include "path/context.h"

namespace gradus::motion {

namespace {

using Row = std::vector<SpecularChain>;

// Moves the chains of all rows into the view, and makes its indices refer to the joined list.
void join(std::vector<Row>* rows, ChainView* view) {
  const auto width = size_t(view->region().width());
  for (size_t row = 0; row < rows->size(); ++row) {
    const auto first = int32_t(view->chains.size());
    for (size_t x = 0; x < width; ++x) {
      int32_t& place = view->places[row * width + x];
      if (place >= 0) place += first;
    }
    view->chains.insert(view->chains.end(), (*rows)[row].begin(), (*rows)[row].end());
    (*rows)[row] = {};
  }
}

// Maximum relative change between the differences on both sides of a pixel. Where it is larger, the pixel lies at an
// edge between facets.
constexpr float kLargestBend = 0.5f;

// Computes one column of the Jacobian: a central difference where both neighbours have the signature of the centre, a
// one-sided difference where only one has it.
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

std::vector<ChainView> view_chains(const CentreView& centres, const GradusSettings& settings,
                                   const lpe::ComponentSet& components, uint32_t wanted,
                                   const CancelCheck& is_cancelled, const Change* change, float non_specular_above) {
  const Region& region = centres.region;
  const auto width = size_t(region.width()), height = size_t(region.height());
  std::vector<int> numbers;
  for (int c = 0; c < components.count(); ++c)
    if ((wanted >> c & 1) != 0) numbers.push_back(c);
  std::vector<ChainView> views(numbers.size(),
                               {&centres, &settings, std::vector<int32_t>(centres.hits.size(), -1), {}});
  std::vector<std::vector<Row>> rows(numbers.size(), std::vector<Row>(height));
  const ChainTracer tracer(*centres.snapshot, centres.camera, settings);
  tbb::parallel_for(size_t{0}, height, [&](size_t y) {
    std::array<SpecularChain, lpe::kMaxComponents> chains;
    for (size_t x = 0; x < width && !is_cancelled(); ++x) {
      const Vec2 film = path::pixel_centre(region.x0 + int32_t(x), region.y0 + int32_t(y));
      const uint32_t found =
          tracer.find(film, centres.hits[y * width + x], components, wanted, change, non_specular_above, &chains);
      for (size_t k = 0; k < numbers.size(); ++k) {
        if ((found >> numbers[k] & 1) == 0) continue;
        views[k].places[y * width + x] = int32_t(rows[k][y].size());
        rows[k][y].push_back(chains[size_t(numbers[k])]);
      }
    }
  });
  for (size_t k = 0; k < views.size(); ++k) join(&rows[k], &views[k]);
  return views;
}

ChainView view_surfaces(const CentreView& centres, const GradusSettings& settings, const Change* change) {
  const Region& region = centres.region;
  const auto width = size_t(region.width()), pixels = centres.hits.size();
  const float time = centres.snapshot->shutter.time_of_frame();
  ChainView view{&centres, &settings, std::vector<int32_t>(pixels), std::vector<SpecularChain>(pixels)};
  tbb::parallel_for(size_t{0}, pixels, [&](size_t i) {
    const Vec2 film = path::pixel_centre(region.x0 + int32_t(i % width), region.y0 + int32_t(i / width));
    SpecularChain& chain = view.chains[i];
    chain.ray = {centres.camera.ray({film, Vec2(0.0f), time}), GRADUS_VISIBLE_CAMERA, {}};
    view.places[i] = is_none(chain.ray.ray) ? -1 : int32_t(i);
    if (view.places[i] < 0) return;
    const geometry::Hit& hit = centres.hits[i];
    const bool is_surface = hit.valid();
    chain.end = is_surface ? ChainEnd::Surface : ChainEnd::Sky;
    chain.last = hit;
    chain.length = is_surface ? hit.t : 0.0f;
    chain.shown = chain.ray.ray.origin + chain.length * chain.ray.ray.direction;
    chain.is_static = change != nullptr && !change->of_all() && change->is_static(chain.ray.ray, hit, hit.t);
  });
  return view;
}

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
