// Adds splats to a channel: contributions of light paths or Markov chains to any pixel of the film.
//
// The paths are divided into work units. Units are traced in parallel, but their splats are added in the order of the
// units' numbers, so that the sums have the same bits for any number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "film/film.h"

namespace gradus::film {

struct Splat {
  int32_t x = 0, y = 0;     // pixel of the full frame; ignored outside of the region
  Vec4 value = Vec4(0.0f);  // as many values as the channel has per pixel
};

// The result of one work unit.
struct SplatUnit {
  int half = 0;        // half-buffer that receives the splats
  uint64_t paths = 0;  // number of paths, of which some may have no splat
  std::vector<Splat> splats;
};

// Traces a work unit. Called by several threads, once for each unit.
using TraceSplats = std::function<SplatUnit(uint32_t unit)>;

// Number of units per thread of the arena that may be in memory at a time.
inline constexpr uint32_t kSplatUnitsPerThread = 2;

// Traces the work units [0, units) with the threads of the caller's task arena, and adds their splats and numbers of
// paths to a channel. All units are added when the function returns. If `trace` throws, the function throws the same,
// and the channel has the first units only. Values that are not finite count in `counters`. Until the function returns,
// no other code may use `counters` or change the film's list of channels. Throws invalid_argument unless the channel
// takes splats.
//
// Units that finish early are kept in memory until those before them are added. If kSplatUnitsPerThread units per
// thread are begun and not yet added, no further one begins. This cannot deadlock, because no thread waits for a unit:
// TBB's pipeline keeps the result of an early unit in a buffer, and the thread is free for other work. The first unit
// that is not yet added is therefore always traced to its end.
void add_splats(uint32_t units, const TraceSplats& trace, Film* film, Channel* channel, Counters* counters);

}  // namespace gradus::film
