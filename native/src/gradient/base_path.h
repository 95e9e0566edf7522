// What shifts know about the base path.
#pragma once

#include "camera/camera.h"
#include "path/contribution.h"

namespace gradus::gradient {

struct BasePath {
  explicit BasePath(const path::PathContext& context_)
      : context(context_),
        has_same_integrand(!context_.has_transparency && context_.scene.features.has_uniform_visibility &&
                           !context_.kinds_matter && context_.glass_limit < 0.0f) {}

  const path::PathContext& context;
  // Light sampling and BSDF sampling see the same integrand in the whole scene, as weighting them jointly requires
  // (emission_shift.h).
  const bool has_same_integrand;
  const path::Sampler* sampler = nullptr;
  camera::CameraSample camera_sample;
  // The last segment, and the state with which the base has entered it.
  const path::Segment* segment = nullptr;
  path::PathState state;
  bool ends_in_hole = false;  // the segment has met a surface that cuts a hole into the film
  // The vertex x_i at which the last segment starts, its position and the event there; not set if the segment starts at
  // the camera. The vertex itself may be overwritten while offsets are deferred.
  const path::Vertex* from = nullptr;
  Vec3 position = Vec3(0.0f);
  path::ScatterEvent event;

  // Sets the last segment, which ends at `vertex` if it meets a surface.
  void set_segment(const path::RaySource& source, const path::PathState& state_, const path::Segment& segment_,
                   const path::Vertex& vertex) {
    segment = &segment_;
    state = state_;
    ends_in_hole =
        state.shows_background() && segment_.end == path::SegmentEnd::Surface && path::cuts_hole(context, vertex);
    if (source.vertex != nullptr) {
      event = *source.event;
      from = source.vertex;
      position = source.vertex->point.position;
    }
  }
};

}  // namespace gradus::gradient
