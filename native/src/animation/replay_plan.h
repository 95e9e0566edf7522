// What a frame repeats of the one before: whose random numbers its pixels take, and how many of them.
#pragma once

#include <cstdint>
#include <vector>

#include "animation/frame_record.h"
#include "base/cancel_check.h"
#include "film/film.h"
#include "lpe/components.h"

namespace gradus::animation {

// Whether the frame before shows the same pixels, without a cut between. before: nullptr where there is none.
bool follows(const PreviousFrame* before, const scene::Snapshot& now, const GradusSettings& settings);

// Of each pixel of the region the one that shows the same point in the frame before; of components that are seen
// through smooth surfaces the one in which these show the same. Empty once cancelled.
film::ReplayMap make_replay_map(const PreviousFrame& before, const scene::Snapshot& now, const GradusSettings& settings,
                                const lpe::ComponentSet& components, const Region& region, const CancelCheck& cancel);

double mean_of(const std::vector<uint32_t>& counts);

// The samples of each pixel: those of what it replays, the mean in holes, and where that is not known (nullptr, or
// without counts).
std::vector<uint32_t> replayed_counts(const film::ReplayMap& replay_map, const PreviousFrame* before, double mean);

// No more of them than `maximum` on average: where a frame is dearer than the one before, a time limit allows fewer.
void limit_mean(double maximum, std::vector<uint32_t>* counts);

}  // namespace gradus::animation
