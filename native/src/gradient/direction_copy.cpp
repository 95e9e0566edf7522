#include "gradient/direction_copy.h"

#include "gradient/footprint.h"
#include "gradient/half_vector.h"
#include "gradient/offset_rays.h"
#include "gradient/random_replay.h"

namespace gradus::gradient {

bool shares_vertex(const BasePath& base, const Vec3& y, const path::Vertex& z, bsdf::ScatterClass next) {
  return shares_specular_vertex(base.position, y, z.point.position, base.context.scene.curvature(z.point.hit),
                                next == bsdf::ScatterClass::Transmission);
}

bool shares_direction(const BasePath& base, const Vec3& y, const path::Vertex& z, const path::ScatterEvent& event) {
  const float width = event.sample.dirac ? 0.0f : class_width(z.shade.closures, event.scatter_class);
  return looks_similar(base.position, y, z.point.position, width);
}

ShiftFailure copy_direction(const BasePath& base, const path::ScatterEvent& next, OffsetPath* offset,
                            film::Counters* counters) {
  const ShiftedEvent event = event_towards(base.event, *offset->vertex, base.event.sample.wi, 1.0f);
  const ShiftFailure failure = trace_to_own_vertex(base, event, offset, counters);
  if (failure != ShiftFailure::None) {
    return failure;
  }
  const Vec3& y = offset->previous->point.position;
  const path::Vertex& z = *offset->vertex;
  if (replays(base.position, y, z) || shares_vertex(base, y, z, next.scatter_class) ||
      shares_direction(base, y, z, next)) {
    return ShiftFailure::Class;
  }
  offset->stage = OffsetStage::Coupled;
  offset->copies_class_choice = false;
  return offset->include_kind() ? ShiftFailure::None : ShiftFailure::Class;
}

}  // namespace gradus::gradient
