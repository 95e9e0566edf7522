// A few samples that are thrown away, and what they tell: where gradients pay.
//
// The result must not depend on samples that are kept, or L2 would be biased; nor on how many will be taken, on
// threads, or on the region, or sampled planes would (contract 2.1). So every square of the full frame's lattice has
// its own few pixels, two samples each, of a seed of their own; a square is judged by what it and its neighbours show,
// and for L2 against all others.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "integrator/integrator.h"
#include "render/gradient_benefit.h"
#include "render/plan.h"

namespace gradus::render {

struct GradientMap {
  std::vector<uint8_t> pixels;  // of the region: 1 where gradients are sampled
  double share = 0.0;           // of the pixels
  Benefit benefit;              // of the whole region
  uint64_t samples = 0;         // that were taken, and thrown away
  bool all() const { return share == 1.0; }
  bool none() const { return share == 0.0; }
};

// The settings that a pilot's integrator is made for.
GradusSettings pilot_settings(GradusSettings settings);

// What a pilot makes way for.
struct Interruption {
  std::function<bool()> is_due = [] { return false; };  // asked on any thread
  std::function<void()> run = [] {};
};

// Runs in the caller's arena. `integrator`: samples gradients, made for pilot_settings().
// reconstruction: the one that will run, never AUTO.
GradientMap run_pilot(const integrator::Integrator& integrator, const GradusSettings& settings, uint32_t reconstruction,
                      const Region& region, int channels, const std::atomic<bool>& stop,
                      const Interruption& interruption = {});

// Says what was decided, and why.
void explain(const GradientMap& map, Reasons* chosen, Reasons* skipped);

}  // namespace gradus::render
