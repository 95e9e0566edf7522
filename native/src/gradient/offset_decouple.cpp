// Where base and offset cannot go on together, although each goes on.
//
// Their common part is a pair like any other, with its ratio r; what follows is not needed for it. So each goes on by
// itself, the offset like a path of its own pixel, and what either finds is paired with nothing: −C/(1 + r) for the
// base, r·C'/(1 + r) for the offset. An unpaired contribution would count −C. The same happens from the other end, for
// the decision looks at the pair alone:
//   - one of the two rays met a surface to scatter from, and the other did not;
//   - the classes of the two vertices differ, and the base's random number takes them to different ones.
// Both vertices must have been found by rays of the same kind, from the camera, by copied or by replayed events. A
// direction copied at class D will not do: had the offset's next event been of class D, its path would have been
// reconnected.
#include "gradient/class_match.h"
#include "gradient/offset_paths.h"

namespace gradus::gradient {

bool OffsetPaths::base_continues() const {
  return base_segment_->end == path::SegmentEnd::Surface && !base_state_.emission_only && !base_in_holdout_;
}

bool OffsetPaths::continues(const OffsetPath& o) const {
  return o.segment->end == path::SegmentEnd::Surface && !base_state_.emission_only &&
         !(o.from_camera && path::is_holdout(context_, *o.here));
}

// continues: the offset; leaves: it stands at a vertex that was lit.
void OffsetPaths::decouple(int k, ShiftFailure cause, bool continues, bool leaves) {
  OffsetPath& o = offsets_[k];
  count_failure(&counters_, cause);
  if (continues) {
    const path::PathResult& found = decoupled_tracer_.continue_path(*sampler_, o.state, o.here, leaves);
    for (int c = 0; c < context_.components.count(); ++c) {
      add(k, c, pairs_[k].paired(Radiance(0.0f), Radiance(Rgb(found.radiance[size_t(c)]), 0.0f), o.ratio));
    }
    counters_.rays_shift += decoupled_rays_.rays_bounce;
    counters_.rays_shift_shadow += decoupled_rays_.rays_shadow;
    decoupled_rays_ = film::Counters{};
  }
  finalize(&o, OffsetStage::Decoupled);
}

// Where the classes differ and the base's number takes both to the same, the event is copied, but the number is no
// longer free: the probabilities of the class leave r.
void OffsetPaths::decouple_by_class(const path::Vertex& vertex, const path::VertexSample& u) {
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage != OffsetStage::Traced || !o.mixed) {
      continue;
    }
    const bsdf::Closures& base = vertex.shade.closures;
    const bsdf::Closures& offset = o.here->shade.closures;
    if (!choose_same_class(base, offset, u.lobe.x)) {
      decouple(k, ShiftFailure::Class, true, true);
      continue;
    }
    bsdf::ScatterClass chosen;
    if (path::choose_class(base, u.lobe.x, &chosen)) {
      o.ratio *= base.class_probability(chosen) / offset.class_probability(chosen);
    }
  }
}

}  // namespace gradus::gradient
