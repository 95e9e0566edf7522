#include "gradient/offset_paths.h"

#include <algorithm>

#include "gradient/class_match.h"

namespace gradus::gradient {

void count_failure(film::Counters* counters, ShiftFailure cause) {
  switch (cause) {
    case ShiftFailure::Missed:
      ++counters->fail_missed;
      break;
    case ShiftFailure::Occluded:
      ++counters->fail_occluded;
      break;
    case ShiftFailure::Class:
      ++counters->fail_class;
      break;
    case ShiftFailure::TotalReflection:
      ++counters->fail_total_reflection;
      break;
    case ShiftFailure::Side:
      ++counters->fail_side;
      break;
    case ShiftFailure::Density:
      ++counters->fail_density;
      break;
    case ShiftFailure::Jacobian:
      ++counters->fail_jacobian;
      break;
    case ShiftFailure::None:
      break;
  }
}

OffsetPaths::OffsetPaths(const path::PathContext& context, film::Counters* counters, path::CameraVertices* vertices)
    : context_(context),
      counters_(*counters),
      vertices_(*vertices),
      clamps_(is_finite(context.clamp_direct) || is_finite(context.clamp_indirect)),
      joint_(!context.has_transparency && context.uniform_visibility && !context.kinds_matter),
      decoupled_tracer_(context, &decoupled_scratch_, nullptr, &decoupled_rays_, &nobody_) {
  for (OffsetPath& o : offsets_) {
    o.here = &o.storage[0];
    o.previous = &o.storage[1];
    o.reconnected = &o.storage[2];
  }
}

void OffsetPaths::start(const std::array<PairCount, film::kOffsets>& pairs, const integrator::PixelSample& sample,
                        uint32_t wanted) {
  decoupled_tracer_.want(wanted);
  pairs_ = pairs;
  sample_ = &sample;
  for (int c = 0; c < context_.components.count(); ++c) gradient_[size_t(c)].fill(Radiance(0.0f));
}

void OffsetPaths::collect(const path::Contribution& c, const Rgb& weight) {
  if (deferred_vertex_ != nullptr) {
    resume();
  }
  if (c.component != suffix_.component) {
    flush_final();
    suffix_.component = c.component;
  }
  const Rgb tail = suffix_.weight * weight * c.tail;
  if (clamps_) {
    for (int k = 0; k < film::kOffsets; ++k) {
      const OffsetPath& o = offsets_[k];
      if (is_final(o.stage)) {
        const Rgb value = path::clamp_contribution(context_, o.state.throughput * tail, c.indirect);
        add(k, c.component, pairs_[k].paired(Radiance(c.clamped, 0.0f), Radiance(value, 0.0f), o.ratio));
      }
    }
    return;
  }
  suffix_.empty = false;
  suffix_.base += c.clamped;
  suffix_.tail += tail;
}

void OffsetPaths::scale(const Rgb& factor) {
  suffix_.empty = false;
  suffix_.weight *= factor;
}

void OffsetPaths::flush_final() {
  if (suffix_.empty) {
    return;
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (is_final(o.stage)) {
      const Rgb value = o.state.throughput * suffix_.tail;
      add(k, suffix_.component, pairs_[k].paired(Radiance(suffix_.base, 0.0f), Radiance(value, 0.0f), o.ratio));
      o.state.throughput *= suffix_.weight;
    }
  }
  suffix_ = Suffix{};
}

void OffsetPaths::finalize(OffsetPath* o, OffsetStage stage) {
  flush_final();
  open_ -= is_final(o->stage) ? 0 : 1;
  o->stage = stage;
  if (stage != OffsetStage::Shared) {
    o->state.throughput = Rgb(0.0f);
  }
  if (stage == OffsetStage::Failed) {
    o->ratio = 0.0f;
  }
}

// Joins the offset to its base, which share the rest of the path. The stage is Deeper if the limit of transparent
// surfaces may still stop the offset alone.
void OffsetPaths::join(OffsetPath* o) {
  if (!(o->ratio > 0.0f) || !is_finite(o->ratio)) {
    fail(o, ShiftFailure::Jacobian);
  } else if (o->state.ray.state.transparent_depth > base_state_.ray.state.transparent_depth) {
    o->stage = OffsetStage::Deeper;
  } else {
    finalize(o, OffsetStage::Shared);
  }
}

bool OffsetPaths::passes(const OffsetPath& o, int crossed) const {
  return crossed == 0 ||
         uint32_t(o.state.ray.state.transparent_depth) + uint32_t(crossed) <= context_.settings.transparent_max_bounces;
}

void OffsetPaths::fail(OffsetPath* offset, ShiftFailure cause) {
  finalize(offset, OffsetStage::Failed);
  count_failure(&counters_, cause);
}

geometry::Points4 OffsetPaths::offset_points() const {
  return geometry::gather(offsets_[0].here->point, offsets_[1].here->point, offsets_[2].here->point,
                          offsets_[3].here->point, camera_sample_.time);
}

bool OffsetPaths::any(OffsetStage stage) const {
  return std::any_of(offsets_.begin(), offsets_.end(), [stage](const OffsetPath& o) { return o.stage == stage; });
}

void OffsetPaths::pair(int k, const path::Contribution& c, const Rgb& offset_value, float ratio) {
  if (!(ratio > 0.0f) || !is_finite(ratio)) {
    ++counters_.fail_jacobian;
    add_unpaired(k, c);
    return;
  }
  const Radiance offset(path::clamp_contribution(context_, offset_value, c.indirect), 0.0f);
  add(k, c.component, pairs_[k].paired(Radiance(c.clamped, 0.0f), offset, ratio));
}

void OffsetPaths::begin(const path::Sampler& sampler, const camera::CameraSample& sample) {
  sampler_ = &sampler;
  camera_sample_ = sample;
  open_ = 0;
  deferred_vertex_ = nullptr;
  suffix_ = Suffix{};
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    o.stage = pairs_[k].present() ? OffsetStage::Traced : OffsetStage::Absent;
    o.state = path::PathState{};
    o.ratio = o.kind_ratio = 1.0f;
    o.from_camera = true;
    open_ += o.stage == OffsetStage::Traced ? 1 : 0;
    ++(o.stage == OffsetStage::Absent ? counters_.fail_border : counters_.shifts_attempted);
  }
}

void OffsetPaths::note_arrival(const path::RaySource& source, const path::PathState& state,
                               const path::Segment& segment, const path::Vertex& vertex) {
  base_segment_ = &segment;
  base_state_ = state;
  base_in_holdout_ =
      source.vertex == nullptr && segment.end == path::SegmentEnd::Surface && path::is_holdout(context_, vertex);
  if (source.vertex != nullptr) {
    base_event_ = *source.event;
    base_from_ = source.vertex;
    base_position_ = source.vertex->point.position;
  }
  seen_ = Radiance(0.0f);
  for (OffsetPath& o : offsets_) {
    o.light.known = false;
    o.fresh = false;
  }
}

void OffsetPaths::arrive(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
                         const path::Vertex& vertex) {
  if (deferred_vertex_ != nullptr) {
    latest_ = {source, &state, &segment, &vertex};
  }
  if (open_ == 0) {
    return;
  }
  note_arrival(source, state, segment, vertex);
  if (source.vertex == nullptr) {
    trace_camera(state);
  } else if (!reconnects(source.event->scatter_class)) {
    copy_events(source, state);
  } else {
    for (OffsetPath& o : offsets_) {
      if (o.stage == OffsetStage::Traced) {
        o.stage = OffsetStage::Pending;
        o.connection.known = false;
      }
    }
  }
}

// An offset that has passed more transparent surfaces than its base may reach their limit on the shared segments. So
// may the base in the inverse shift.
void OffsetPaths::passed(const path::Segment& segment) {
  scale(segment.weight);
  if (open_ == 0) {
    return;
  }
  for (OffsetPath& o : offsets_) {
    if (!is_beside(o.stage)) {
      continue;
    }
    if (!passes(o, segment.crossed)) {
      fail(&o, ShiftFailure::Occluded);
      continue;
    }
    o.state.throughput *= segment.weight;
    uint16_t& depth = o.state.ray.state.transparent_depth;
    depth = static_cast<uint16_t>(depth + segment.crossed);
  }
}

// The base decides Russian roulette. Both contributions are divided by its probability, and r excludes it.
void OffsetPaths::survived(float probability, const path::Vertex& vertex) {
  const float factor = 1.0f / probability;
  scale(Rgb(factor));
  if (open_ == 0) {
    return;
  }
  for (OffsetPath& o : offsets_) {
    if (is_final(o.stage)) {
      continue;  // flush_final() applies the factor
    }
    o.state.throughput *= factor;
    if (o.stage == OffsetStage::Pending) {
      o.connection.throughput *= factor;  // the connection may exist already, because emission() needed it
    } else if (o.stage == OffsetStage::Traced) {
      path::shade_vertex(context_, o.state.ray.state, o.here);
      o.mixed = !same_classes(vertex.shade.closures, o.here->shade.closures);
    }
  }
  replay_short_edges(vertex);
}

}  // namespace gradus::gradient
