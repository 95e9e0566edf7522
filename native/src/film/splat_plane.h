// Sums of splats: contributions of a light path or Markov chain to any pixel of the film. The plane is normalised by
// the total number of paths, whereas the other planes of a film are normalised by the sample count of each pixel.
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
  int32_t x = 0, y = 0;  // pixel of the full frame; ignored outside of the region
  Radiance value = Radiance(0.0f);
};

class SplatPlane {
 public:
  explicit SplatPlane(const Region& region);

  // Adds the splats of work unit `unit` (0, 1, 2 …, each once) and its number of paths. Thread-safe.
  void merge(uint32_t unit, uint64_t paths, std::vector<Splat> splats, Counters* counters);
  // Returns the number of paths of all units that have been added.
  uint64_t paths() const;
  // Returns the sums divided by the number of paths, row-major over the region.
  std::vector<Radiance> mean() const;

 private:
  struct Unit {
    uint64_t paths = 0;
    std::vector<Splat> splats;
  };
  void add(const Unit& unit, Counters* counters);

  const Region region_;
  mutable std::mutex mutex_;
  std::map<uint32_t, Unit> early_;
  uint32_t next_ = 0;
  uint64_t paths_ = 0;
  std::vector<Radiance> sums_;
};

}  // namespace gradus::film
