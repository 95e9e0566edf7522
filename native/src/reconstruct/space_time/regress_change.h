// Estimate of the change of pixels along their correspondences from one frame to the next, by regression of the sampled
// change on features. Where nothing changes the estimate is exactly 0.
#pragma once

#include <memory>

#include "base/cancel_check.h"
#include "film/features.h"
#include "reconstruct/space_time/correspondence_map.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

// Change from one frame to the next. Components may have different correspondences.
struct Change {
  std::vector<CorrespondenceMap> correspondence;  // one for each component
  // Difference of each component, in the channels of its source; undefined for pixels without a correspondence.
  std::vector<Field> difference;
  Field weight;  // 1/(estimated squared error of the sum of a pixel's differences)
};

using ComponentSources = std::vector<std::unique_ptr<HalvedWindowSource>>;

// Estimates the change from frame t to t + 1. All components go through the regression of their sum. `pictures` are the
// images of the components in frame t; they show which part of the change comes from rounding correspondences to whole
// pixels. `features` are those of the frame, filtered; `scale` is its median luminance.
Change regress_change(const ComponentSources& components, int t, const std::vector<Field>& pictures,
                      const film::Features& features, float scale, const CancelCheck& cancel);

}  // namespace gradus::reconstruct
