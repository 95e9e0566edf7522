#include "gradient/random_replay.h"

#include "gradient/decoupling.h"
#include "gradient/footprint.h"
#include "gradient/offset_rays.h"

namespace gradus::gradient {

namespace {

// Compares the two samples. The side and the kind of a bounce (diffuse or not) are part of the path, so they must
// agree.
ShiftFailure compare_samples(const bsdf::BsdfSample& x, const bsdf::BsdfSample& y) {
  if (x.dirac != y.dirac || x.diffuse != y.diffuse) {
    return ShiftFailure::Class;
  }
  return x.transmitted != y.transmitted ? ShiftFailure::Side : ShiftFailure::None;
}

}  // namespace

ShiftedEvent replay_event(const path::Vertex& x, const path::ScatterEvent& event, const path::VertexSample& u,
                          const path::Vertex& y) {
  const bsdf::ScatterClass c = event.scatter_class;
  const float probability = y.shade.closures.class_probability(c);
  bsdf::BsdfSample sample;
  if (!(probability > 0.0f)) {
    return failed_event(ShiftFailure::Class);
  }
  if (!y.shade.closures.sample(c, y.wo, u.lobe.y, u.bsdf, &sample)) {
    return failed_event(ShiftFailure::Density);
  }
  const ShiftFailure failure = compare_samples(event.sample, sample);
  if (failure != ShiftFailure::None) {
    return failed_event(failure);
  }
  if (!sample.dirac && path::is_clear(event.glass_limit, y, c, sample.wi, sample.transmitted) != event.is_clear) {
    return failed_event(ShiftFailure::Class);
  }
  const bsdf::BsdfEval of_kind = event.by_kind ? sample.kind : bsdf::BsdfEval{sample.value, sample.pdf};
  ShiftedEvent shifted = weigh_event(event, sample.wi, of_kind.value, probability * of_kind.pdf, 1.0f);
  shifted.pdf = probability * sample.pdf;
  shifted.ratio = probability / x.shade.closures.class_probability(c);
  return shifted;
}

bool replays(const Vec3& x, const Vec3& y, const path::Vertex& z) {
  const bool non_specular = z.shade.closures.non_specular_probability() > 0.0f;
  return non_specular && is_short_edge(x, y, z.point.position);
}

ShiftFailure replay(const BasePath& base, const path::Vertex& z, OffsetPath* offset, film::Counters* counters) {
  const int depth = base.state.depth - 1;
  const path::VertexSample u = base.event.is_exit ? base.sampler->walk_end(depth) : base.sampler->vertex(depth);
  const ShiftedEvent event = replay_event(*base.from, base.event, u, *offset->vertex);
  const ShiftFailure failure = trace_to_own_vertex(base, event, offset, counters);
  if (failure != ShiftFailure::None) {
    return failure;
  }
  if (!replays(base.position, offset->previous->point.position, *offset->vertex)) {
    return ShiftFailure::Class;
  }
  offset->stage = OffsetStage::Coupled;
  offset->copies_class_choice = !same_classes(z.shade.closures, offset->vertex->shade.closures);
  return offset->include_kind() ? ShiftFailure::None : ShiftFailure::Class;
}

}  // namespace gradus::gradient
