#include "film/splats.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "base/error.h"
#include "film/finite_check.h"

namespace gradus::film {
namespace {

void add_unit(const SplatUnit& unit, Film* film, Channel* channel, Counters* counters) {
  for (const Splat& splat : unit.splats) {
    if (film->region.contains(splat.x, splat.y))
      add_feature(&splat.value.x, 1.0f, film->index(splat.x, splat.y), unit.half, channel, counters);
  }
  channel->paths[channel->buffer_of(unit.half)] += unit.paths;
}

}  // namespace

void add_splats(uint32_t units, const TraceSplats& trace, Film* film, Channel* channel, Counters* counters) {
  if (!channel->info.takes_splats) throw invalid_argument("channel " + channel->info.name + " takes no splats");
  // The pipeline passes numbers of units, whose results are in slots: oneTBB loses what its tokens own if an exception
  // ends a pipeline. No two units in the pipeline share a slot, because they leave it in order.
  std::vector<SplatUnit> slots(kSplatUnitsPerThread * size_t(tbb::this_task_arena::max_concurrency()));
  uint32_t next = 0;
  const auto number = [&](tbb::flow_control& control) {
    if (next == units) control.stop();
    return next++;
  };
  const auto trace_unit = [&](uint32_t unit) {
    slots[unit % slots.size()] = trace(unit);
    return unit;
  };
  const auto add = [&](uint32_t unit) { add_unit(slots[unit % slots.size()], film, channel, counters); };
  tbb::parallel_pipeline(slots.size(),
                         tbb::make_filter<void, uint32_t>(tbb::filter_mode::serial_in_order, number) &
                             tbb::make_filter<uint32_t, uint32_t>(tbb::filter_mode::parallel, trace_unit) &
                             tbb::make_filter<uint32_t, void>(tbb::filter_mode::serial_in_order, add));
}

}  // namespace gradus::film
