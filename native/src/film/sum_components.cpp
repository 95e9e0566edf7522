#include "film/sum_components.h"

#include <tbb/parallel_for.h>

namespace gradus::film {
namespace {

void add(const std::vector<Radiance>& from, std::vector<Radiance>* to) {
  tbb::parallel_for(size_t{0}, to->size(), [&](size_t i) { (*to)[i] += from[i]; });
}

}  // namespace

Film sum_components(const Film& film) {
  Film sum(film.full_width, film.full_height, film.region, film.channels, 1, film.gradients);
  sum.count = film.count;
  sum.pair_count = film.pair_count;
  sum.settings = film.settings;
  ComponentPlanes& to = sum.components[0];
  for (const ComponentPlanes& from : film.components) {
    for (size_t half = 0; half < kHalves; ++half) {
      add(from.primal[half], &to.primal[half]);
      for (size_t offset = 0; offset < kOffsets; ++offset) add(from.gradient[half][offset], &to.gradient[half][offset]);
    }
  }
  return sum;
}

}  // namespace gradus::film
