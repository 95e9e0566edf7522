// How the light of pixels changes along their links from a frame to the next: what was sampled of it, by regression on
// features. Where nothing changes it is exactly 0.
#pragma once

#include <memory>

#include "film/features.h"
#include "reconstruct/solver.h"
#include "reconstruct/space_time/correspondence_map.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

// From one frame to the next, of components that may go different ways.
struct Change {
  std::vector<CorrespondenceMap> correspondence;  // of each
  std::vector<Field> difference;  // likewise, channels of the sources; of pixels without a link any number
  Field weight;                   // 1/(estimated squared error of all differences of a pixel together)
};

using ComponentSources = std::vector<std::unique_ptr<HalvedWindowSource>>;

// From frame t on. All components go through one regression, that of their sum. pictures: of the components of the
// frame, by which the part of the change that links to whole pixels make is known; features: the frame's, filtered;
// scale: its median luminance.
Change regress_change(const ComponentSources& components, int t, const std::vector<Field>& pictures,
                      const film::Features& features, float scale, const CancelCheck& cancel);

}  // namespace gradus::reconstruct
