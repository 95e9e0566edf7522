#include "gradient/subsurface_shift.h"

#include "path/subsurface.h"

namespace gradus::gradient {

ShiftFailure replay_below(const BasePath& base, const path::Vertex& entry, OffsetPath* offset,
                          film::Counters* counters) {
  constexpr auto below = bsdf::ScatterClass::Subsurface;
  const float probability = offset->vertex->shade.closures.class_probability(below);
  if (!(probability > 0.0f)) {
    return ShiftFailure::Class;
  }
  ++counters->shifts_replayed;
  offset->advance();
  path::SubsurfaceEvent event;
  if (!path::scatter_below(base.context, *base.sampler, base.state.depth, offset->state.ray.state, *offset->previous,
                           &event, offset->vertex)) {
    return ShiftFailure::Missed;
  }
  offset->state.throughput *= event.factor;
  offset->ratio *= probability / entry.shade.closures.class_probability(below);
  offset->copies_class_choice = false;
  offset->light.is_known = false;
  offset->has_own_segment = false;
  return offset->ratio > 0.0f ? ShiftFailure::None : ShiftFailure::Density;
}

}  // namespace gradus::gradient
