// Which parts of the picture are good enough (contract 5.3).
#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"
#include "reconstruct/solver.h"

namespace gradus {

// Cells of 16×16 whose estimated relative error is below the threshold stop; once stopped they stay so.
class NoiseStop {
 public:
  NoiseStop(const Region& region, float threshold);
  // Judges all cells. solves: the error is that of the L2 reconstruction, from the difference of the reconstructions of both halves
  // (contract 1.2), else that of the noisy image.
  void update(const Frame& frame, bool solves, float alpha, const CancelTest& cancel);
  bool all_done() const { return active_ == 0; }
  bool any_done() const { return active_ < cells_.size(); }
  // Samples per pixel of the region for the next batch: 0 where a cell is done.
  std::vector<uint32_t> count_map(uint32_t count) const;

 private:
  Region region_;
  float threshold_;
  std::vector<Region> cells_;
  std::vector<bool> done_;
  size_t active_;
};

}  // namespace gradus
