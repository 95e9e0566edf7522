// Sums of samples that do not belong to the pixel that asked for them (contract 1.3): a light path or a chain adds to
// whatever pixels it meets. The plane is normalised globally, by the number of paths, where the planes of a frame are
// normalised by their pixels' counts.
//
// Workers hand in a unit's splats as a whole. They are added in the order of the units' numbers, whoever comes first,
// so that the sums have the same bits for any number of threads; units that are early wait in memory, as many as there
// are workers.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "film/film.h"

namespace gradus::film {

struct Splat {
  int32_t x = 0, y = 0;  // pixel of the full frame; outside of the region it is left out
  Radiance value = Radiance(0.0f);
};

class SplatPlane {
 public:
  explicit SplatPlane(const Region& region);

  // The paths of unit number `unit` (0, 1, 2 …, each once) and what they have splatted. Thread-safe.
  void merge(uint32_t unit, uint64_t paths, std::vector<Splat> splats, Counters* counters);
  // Paths of the units that are in the sums.
  uint64_t paths() const;
  // Sum over all paths divided by their number; row-major over the region.
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
