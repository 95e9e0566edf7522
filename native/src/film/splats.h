// Adds splats to a channel: contributions of a light path or Markov chain to any pixel of the film.
//
// Workers submit all splats of a work unit at once. Units are added in the order of their numbers, so that the sums
// have the same bits for any number of threads. Units that finish early wait in memory, at most as many as there are
// workers.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "film/film.h"

namespace gradus::film {

struct Splat {
  int32_t x = 0, y = 0;     // pixel of the full frame; ignored outside of the region
  Vec4 value = Vec4(0.0f);  // as many values as the channel has per pixel
};

class SplatQueue {
 public:
  // Fills a channel of the film, whose list of channels must not change meanwhile. Throws invalid_argument unless the
  // channel takes splats.
  SplatQueue(Film* film, Channel* channel);

  // Adds the splats of work unit `unit` (0, 1, 2 …, each once) and its number of paths to a half-buffer. Thread-safe.
  // Values that are not finite count in `counters`.
  void merge(uint32_t unit, int half, uint64_t paths, std::vector<Splat> splats, Counters* counters);

 private:
  struct Unit {
    int half = 0;
    uint64_t paths = 0;
    std::vector<Splat> splats;
  };
  void add(const Unit& unit, Counters* counters);

  Film* const film_;
  Channel* const channel_;
  std::mutex mutex_;
  std::map<uint32_t, Unit> early_;
  uint32_t next_ = 0;
};

}  // namespace gradus::film
