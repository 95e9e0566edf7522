// The pilot: takes a few samples, finds by them where gradients reduce the error at equal time, and discards them.
//
// The map must not depend on samples that are kept, or L2 would be biased. It must not depend on the number of samples,
// threads or the region, or the sampled planes would depend on them. So every block of the full frame has its own few
// test pixels with two samples each, of a separate seed. A block is judged by its test pixels and those of its
// neighbours, and for L2 against all other blocks.
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
  std::vector<uint8_t> pixels;  // by pixel of the region: 1 where gradients are sampled
  double share = 0.0;           // share of the pixels with gradients
  Benefit benefit;              // benefit over the whole region
  uint64_t samples = 0;         // number of samples of the pilot, which are discarded
  double cpu_seconds = 0.0;     // CPU time of the threads that took them
  bool all() const { return share == 1.0; }
  bool none() const { return share == 0.0; }
};

// Returns the settings for the integrator of a pilot.
GradusSettings pilot_settings(GradusSettings settings);

// Other work that interrupts a pilot.
struct Interruption {
  std::function<bool()> is_due = [] { return false; };  // called from any thread
  std::function<void()> run = [] {};
};

// Takes the samples of the pilot in the caller's task arena and returns where gradients are used. `integrator` samples
// gradients and was made for pilot_settings(). `reconstruction` is the one that will run, never AUTO. Returns an empty
// map if `stop` becomes true.
GradientMap run_pilot(const integrator::Integrator& integrator, const GradusSettings& settings, uint32_t reconstruction,
                      const Region& region, int channels, const std::atomic<bool>& stop,
                      const Interruption& interruption = {});

// Adds the decision and its reason to `chosen` or `skipped`.
void explain(const GradientMap& map, Reasons* chosen, Reasons* skipped);

}  // namespace gradus::render
