// Edges at which adjacent pixels move in different ways. A pixel there holds light of both sides, which belongs to no
// pixel that shows one side alone.
#pragma once

#include "film/replay_map.h"
#include "motion/pixel_matching.h"

namespace gradus::motion {

// Removes from the correspondence of all light the pixels that lie at such an edge in one of the frames and more than a
// pixel away from one in the other. Examples are the outline of a ball that rolls on, whose surface turns into view,
// and what a mirror that turns shows at its frame. `from`, `to`: the views of the two frames.
void leave_out_parting_edges(const CentreView& from, const CentreView& to, film::PixelCorrespondence* correspondence);

}  // namespace gradus::motion
