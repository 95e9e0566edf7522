// Plans the replay of the previous frame: the pixel whose random numbers each pixel takes, and its number of samples.
#pragma once

#include <cstdint>
#include <vector>

#include "animation/frame_record.h"
#include "base/cancel_check.h"
#include "film/film.h"
#include "lpe/components.h"

namespace gradus::animation {

// Whether the frame can replay the previous one: both show the same region at the same size, and there is no shot
// change between them. before: nullptr if there is no previous frame.
bool follows(const PreviousFrame* before, const scene::Snapshot& now, const GradusSettings& settings);

// Returns for each pixel of the frame `fresh` the pixel of the previous frame that shows the same surface point.
// Components that are seen through smooth surfaces have maps of their own, to the pixel in which the smooth surfaces
// show the same point. If frames are joined and nothing is replayed, all light of a pixel follows what it mainly shows:
// the point that is seen in a mirror or clear glass, and other surfaces themselves; and pixels that lie at an edge in
// one of both frames alone have none (motion/parting_edges.h). The map is empty after cancelling.
// now: view of the frame's snapshot over the region of `fresh`. The view that `before` keeps is used if it has the same
// region.
film::ReplayMap make_replay_map(const PreviousFrame& before, const motion::CentreView& now,
                                const GradusSettings& settings, const lpe::ComponentSet& components,
                                const film::FilmHeader& fresh, const CancelCheck& cancel);

double mean_of(const std::vector<uint32_t>& counts);

// Returns the number of replayed samples of each pixel: that of the pixel that it replays, or `mean` in disocclusions
// and where the counts of the previous frame are not known. before: nullptr, or a frame that may have counts.
std::vector<uint32_t> replayed_counts(const film::ReplayMap& replay_map, const PreviousFrame* before, double mean);

// Scales the counts so that their mean is at most `maximum`, but keeps at least one sample per pixel. A time limit
// allows fewer samples where a frame takes longer than the previous one.
void limit_mean(double maximum, std::vector<uint32_t>* counts);

}  // namespace gradus::animation
