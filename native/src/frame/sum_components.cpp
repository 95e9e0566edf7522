#include "frame/sum_components.h"

#include <tbb/parallel_for.h>

namespace gradus {
namespace {

void add(const std::vector<Radiance>& from, std::vector<Radiance>* to) {
  tbb::parallel_for(size_t{0}, to->size(), [&](size_t i) { (*to)[i] += from[i]; });
}

}  // namespace

Frame sum_components(const Frame& frame) {
  Frame sum(frame.full_width, frame.full_height, frame.region, frame.channels, 1, frame.gradients);
  sum.count = frame.count;
  sum.pair_count = frame.pair_count;
  sum.settings = frame.settings;
  ComponentPlanes& to = sum.components[0];
  for (const ComponentPlanes& from : frame.components) {
    for (size_t half = 0; half < kHalves; ++half) {
      add(from.primal[half], &to.primal[half]);
      for (size_t offset = 0; offset < kOffsets; ++offset) add(from.gradient[half][offset], &to.gradient[half][offset]);
    }
  }
  return sum;
}

}  // namespace gradus
