// Light and shadow linking: which surfaces an emitter lights, and which surfaces block its light. As in Cycles, every
// surface belongs to one of 64 light sets as a receiver and to one of 64 shadow sets as a blocker. An emitter names
// sets by their bits.
#pragma once

#include <cstdint>

namespace gradus::geometry {

// Bits of all sets: an emitter without links.
inline constexpr uint64_t kAllSets = ~uint64_t{0};

// The links of an emitter.
struct EmitterLinks {
  uint64_t receivers = kAllSets;  // light sets that it lights
  uint64_t blockers = kAllSets;   // shadow sets that block it

  bool has_receivers() const { return receivers != kAllSets; }
  bool has_blockers() const { return blockers != kAllSets; }
};

// Returns the links of masks from the caller, in which 0 stands for all sets.
inline EmitterLinks emitter_links(uint64_t receivers, uint64_t blockers) {
  return {receivers != 0 ? receivers : kAllSets, blockers != 0 ? blockers : kAllSets};
}

}  // namespace gradus::geometry
