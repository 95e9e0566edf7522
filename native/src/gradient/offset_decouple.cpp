// Decoupling: base and offset share no further vertices, although at least one of them continues.
//
// Their common prefix is a pair with ratio r like any other, and the rest of the path does not change r. So each path
// continues separately, the offset like a path of its own pixel. Contributions behind the prefix are paired with 0:
// −C/(1 + r) for the base and r·C'/(1 + r) for the offset. An unpaired contribution would count −C. The inverse shift
// does the same, because the decision depends on the pair alone. Paths decouple in two cases:
//   - One of the two rays met a surface that scatters, and the other did not.
//   - The classes of the two vertices differ, and the base's random number chooses different ones.
// Rays of the same kind must have found both vertices: from the camera, by copied events, or by replayed events. A
// direction copied at class D does not qualify: if the offset's next event were of class D, its path would have been
// reconnected.
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

// Decouples offset k because of `cause`, and traces the rest of its path if `continues`. `leaves` says that light
// samples at its vertex are complete and that it scatters next.
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

// Decouples the offsets whose vertex differs in its classes from the base's, if the base's random number chooses
// different classes. Otherwise the event is copied; the random number is no longer a free coordinate, so the
// probabilities of the class are removed from r.
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
