// What a sequence remembers of its frames, besides their files.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "plan/plan.h"
#include "render/stats.h"
#include "scene/snapshot.h"

namespace gradus {

// The frame before the next one that is sampled.
struct FrameBefore {
  std::shared_ptr<const Snapshot> snapshot;
  GradusSettings settings{};
  int32_t stream_frame = 0;      // whose random numbers it has taken: its own, or those of the first of several that are alike
  std::vector<uint32_t> counts;  // samples of each pixel; empty: as many as the settings say
  bool is_sampled = true;        // false: it was passed by
};

// How a frame was sampled, for the stats of its delivery.
struct FrameRecord {
  Plan plan;
  RenderStats stats;
};

}  // namespace gradus
