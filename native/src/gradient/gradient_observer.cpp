#include "gradient/gradient_observer.h"

#include <algorithm>
#include <utility>

#include "gradient/direction_copy.h"
#include "gradient/emission_shift.h"
#include "gradient/half_vector.h"
#include "gradient/light_shift.h"
#include "gradient/offset_rays.h"
#include "gradient/random_replay.h"
#include "gradient/reconnection.h"
#include "gradient/subsurface_shift.h"

namespace gradus::gradient {

GradientObserver::GradientObserver(const path::PathContext& context, film::Counters* counters,
                                   path::CameraVertices* vertices)
    : context_(context),
      counters_(*counters),
      vertices_(*vertices),
      base_(context),
      accumulator_(context, &offsets_, counters),
      decoupled_tracer_(context) {}

void GradientObserver::start(const PairCounts& pairs, const integrator::PixelSample& sample, uint32_t wanted) {
  decoupled_tracer_.want(wanted);
  accumulator_.start(pairs);
  sample_ = &sample;
}

void GradientObserver::on_path_start(const path::Sampler& sampler, const camera::CameraSample& sample) {
  base_.sampler = &sampler;
  base_.camera_sample = sample;
  deferred_vertex_ = nullptr;
  open_ = 0;
  for (int k = 0; k < film::kOffsets; ++k) {
    const bool is_present = accumulator_.has_pair(k);
    offsets_[k].start(is_present);
    open_ += is_present ? 1 : 0;
    ++(is_present ? counters_.shifts_attempted : counters_.fail_border);
  }
}

// ---- A segment of the base path ----

// Traces the offsets' rays that correspond to the base's segment.
void GradientObserver::on_segment(const path::RaySource& source, const path::PathState& state,
                                  const path::Segment& segment, const path::Vertex& vertex) {
  if (deferred_vertex_ != nullptr) {
    latest_ = {source, &state, &segment, &vertex};
  }
  if (open_ == 0) {
    return;
  }
  begin_segment(source, state, segment, vertex);
  if (source.vertex == nullptr) {
    trace_camera_rays(base_, *sample_, &vertices_, &offsets_, &counters_);
  } else if (!reconnects(source.event->scatter_class)) {
    copy_specular_events(source);
  } else {
    for (OffsetPath& o : offsets_) {
      if (o.stage == OffsetStage::Coupled) {
        o.stage = OffsetStage::Pending;
        o.connection.is_known = false;
      }
    }
  }
}

void GradientObserver::begin_segment(const path::RaySource& source, const path::PathState& state,
                                     const path::Segment& segment, const path::Vertex& vertex) {
  base_.set_segment(source, state, segment, vertex);
  base_emission_ = Radiance(0.0f);
  for (OffsetPath& o : offsets_) {
    o.light.is_known = false;
    o.has_own_segment = false;
  }
}

// Copies the base's last event, of class R or T, to the last vertices of the offsets. Behind glass the rays diverge, so
// single rays are faster than a packet.
void GradientObserver::copy_specular_events(const path::RaySource& source) {
  for (OffsetPath& o : offsets_) {
    if (o.stage != OffsetStage::Coupled) {
      continue;
    }
    // Attempts are counted; there are none in a scene for which the planner skips these shifts.
    ++counters_.shifts_half_vector;
    const ShiftedEvent event = copy_event(*source.vertex, *source.event, *o.vertex);
    if (event.failure != ShiftFailure::None) {
      fail(event.failure, &o);
      continue;
    }
    leave_by_event(base_, event, source.event->sample.dirac, &o);
    trace_own_segment(base_, nullptr, &o, &counters_);
  }
}

// Pending offsets cannot connect to what the base has found behind a portal. The inverse shift never needs to, because
// a connection is straight.
//
// An offset that has passed more transparent surfaces than its base may reach their limit on the shared segments. So
// may the base in the inverse shift.
void GradientObserver::on_segment_passed(const path::Segment& segment) {
  accumulator_.scale_suffix(segment.weight);
  if (open_ == 0) {
    return;
  }
  for (OffsetPath& o : offsets_) {
    if (segment.passes_portal && o.stage == OffsetStage::Pending) {
      fail(ShiftFailure::Class, &o);
    }
    if (!shares_segments(o.stage)) {
      continue;
    }
    if (!o.can_cross(segment.crossed, context_.max_transparent)) {
      fail(ShiftFailure::Occluded, &o);
      continue;
    }
    o.state.throughput *= segment.weight;
    uint16_t& depth = o.state.ray.state.transparent_depth;
    depth = static_cast<uint16_t>(depth + segment.crossed);
  }
}

// ---- Emission on the segment ----

bool GradientObserver::add_base_emission(const path::Contribution& c, const Rgb& segment_weight) {
  add_to_suffix(c, segment_weight);
  if (open_ > 0) {
    base_emission_ += Radiance(c.clamped, 0.0f);
  }
  return open_ > 0;
}

void GradientObserver::on_light_crossing(const path::RaySource& source, const path::Contribution& c,
                                         const path::LightCrossing& crossing) {
  if (!add_base_emission(c, crossing.weight)) {
    return;
  }
  const shading::RayState& state = base_.state.ray.state;
  const bool is_needed = has_offset_at(OffsetStage::Pending) || has_offset_at(OffsetStage::Reconnected);
  const light::LightEvaluation base_view =
      source.vertex != nullptr && is_needed
          ? path::evaluate_crossing(context_, crossing.point, path::receiver_of(*source.vertex), state)
          : light::LightEvaluation{};
  for (int k = 0; k < film::kOffsets; ++k) {
    const OffsetPath& o = offsets_[k];
    if (o.has_own_segment) {
      continue;  // on_emission_complete() compares the two segments
    }
    if (shares_segments(o.stage) && !o.can_cross(crossing.crossed, context_.max_transparent)) {
      accumulator_.add(k, c, unpaired());
    } else if (shares_segments(o.stage)) {
      accumulator_.add(k, c,
                       share_emission(base_, source, c, crossing.weight, weights_jointly(base_, base_view, o), o));
    } else if (o.stage == OffsetStage::Pending && crossing.is_behind_portal) {
      accumulator_.add(k, c, unpaired());
    } else if (o.stage == OffsetStage::Pending) {
      const light::LightEvaluation view =
          path::evaluate_crossing(context_, crossing.point, path::receiver_of(*o.vertex), state);
      accumulator_.add(
          k, c,
          copy_light_point(base_, source, c, crossing.point, base_view, view, crossing.probability, o, &counters_));
    }
  }
}

void GradientObserver::on_world(const path::RaySource& source, const path::Contribution& c) {
  if (!add_base_emission(c, Rgb(1.0f))) {
    return;
  }
  light::LightEvaluation base_view;
  base_view.direction = base_.state.ray.ray.direction;
  base_view.visibility = context_.scene.world.visibility;
  const light::LightPoint sampled = has_offset_at(OffsetStage::Pending)
                                        ? light::light_point_of_world(context_.scene, base_view.direction)
                                        : light::LightPoint{};
  for (int k = 0; k < film::kOffsets; ++k) {
    const OffsetPath& o = offsets_[k];
    if (o.has_own_segment) {
      continue;
    }
    if (shares_segments(o.stage)) {
      accumulator_.add(k, c, share_emission(base_, source, c, Rgb(1.0f), weights_jointly(base_, base_view, o), o));
    } else if (o.stage == OffsetStage::Pending) {
      // The offset copies the direction, so it sees the same radiance.
      light::LightEvaluation view = base_view;
      view.radiance = c.light;
      view.pdf = path::light_pdf(context_, path::RaySource{o.vertex, source.event}, sampled);
      light::LightPoint point = sampled;
      point.kind = light::LightKind::World;  // even if light sampling excludes the world
      accumulator_.add(
          k, c, copy_light_point(base_, source, c, point, base_view, view, base_.segment->probability, o, &counters_));
    }
  }
}

// Offsets with a segment of their own have an alpha of their own (own_emission()). Other shifts do not keep alpha:
// behind clear glass of class D both ends of a pair leave it unpaired.
void GradientObserver::on_transparency(float value) {
  const Radiance transparency(0.0f, 0.0f, 0.0f, -value);
  base_emission_ += transparency;
  for (int k = 0; k < film::kOffsets; ++k) {
    const OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Absent || o.stage == OffsetStage::Coupled) continue;
    const float ratio = o.stage == OffsetStage::Decoupled ? o.ratio : 0.0f;
    accumulator_.add_pair(k, context_.components.alpha_component(), transparency, Radiance(0.0f), ratio);
  }
}

void GradientObserver::on_emission(const path::RaySource& source, const path::Contribution& c,
                                   const path::Vertex& vertex) {
  if (!add_base_emission(c, Rgb(1.0f))) {
    return;
  }
  connect_pending(base_, vertex, &offsets_, &counters_);
  const light::LightPoint point = has_offset_at(OffsetStage::Pending)
                                      ? light::light_point_of_surface(context_.scene, vertex.point)
                                      : light::LightPoint{};
  for (int k = 0; k < film::kOffsets; ++k) {
    const OffsetPath& o = offsets_[k];
    if (o.has_own_segment) {
      continue;
    }
    if (shares_segments(o.stage)) {
      // The condition is the same as for light samples at this vertex.
      const bool is_joint = base_.has_same_integrand && !o.copies_class_choice;
      accumulator_.add(k, c, share_emission(base_, source, c, Rgb(1.0f), is_joint, o));
    } else if (o.stage == OffsetStage::Pending) {
      accumulator_.add(k, c, connect_to_emission(base_, source, c, point, vertex, o));
    }
  }
}

// Compares the emission on segments of the offsets' own, and completes the stage of offsets behind the segment.
void GradientObserver::on_emission_complete() {
  is_on_deferred_segment_ = false;
  if (open_ == 0) {
    return;
  }
  // This component is that of base and offset, because the shift copies classes.
  const int component = context_.components.component(base_.state.lpe_state);
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.has_own_segment) {
      const Radiance emission = own_emission(base_, &o);
      if (emission != Radiance(0.0f) || base_emission_ != Radiance(0.0f)) {
        add_own_pair(k, component, emission);
      }
    }
    if ((o.stage == OffsetStage::Coupled || o.stage == OffsetStage::Reconnected) && !o.include_kind()) {
      fail(ShiftFailure::Class, &o);
    }
    if (o.has_own_segment && o.stage == OffsetStage::Coupled && continues(base_, o) != continues(base_)) {
      decouple(k, ShiftFailure::Missed, continues(base_, o), false);
    }
    if (o.stage == OffsetStage::Reconnected) {
      share_rest(&o);
    }
    if (o.stage == OffsetStage::Deeper && path::is_at_transparent_limit(context_, o.state.ray.state)) {
      fail(ShiftFailure::Occluded, &o);  // its path ends with the emission, whether or not that of the base does
    }
  }
}

void GradientObserver::add_own_pair(int k, int component, const Radiance& emission) {
  const float ratio = offsets_[k].ratio;
  const int of_alpha = context_.components.alpha_component();
  if (component == of_alpha) {
    accumulator_.add_pair(k, component, base_emission_, emission, ratio);
    return;
  }
  accumulator_.add_pair(k, component, Radiance(Rgb(base_emission_), 0.0f), Radiance(Rgb(emission), 0.0f), ratio);
  accumulator_.add_pair(k, of_alpha, Radiance(0.0f, 0.0f, 0.0f, base_emission_.w),
                        Radiance(0.0f, 0.0f, 0.0f, emission.w), ratio);
}

// ---- The base's vertex at the end of the segment ----

// The base decides Russian roulette. Both contributions are divided by its probability, and r excludes it.
void GradientObserver::on_survival(float probability, const path::Vertex& vertex) {
  const float factor = 1.0f / probability;
  accumulator_.scale_suffix(Rgb(factor));
  if (open_ == 0) {
    return;
  }
  for (OffsetPath& o : offsets_) {
    if (is_final(o.stage)) {
      continue;  // the suffix has the factor
    }
    o.state.throughput *= factor;
    if (o.stage == OffsetStage::Pending) {
      o.connection.throughput *= factor;  // the connection may exist already, because on_emission() needed it
    } else if (o.stage == OffsetStage::Coupled) {
      path::shade_vertex(context_, o.state.ray.state, o.vertex);
      o.copies_class_choice = !same_classes(vertex.shade.closures, o.vertex->shade.closures);
    }
  }
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending && replays(base_.position, o.vertex->point.position, vertex)) {
      fail_if(replay(base_, vertex, &o, &counters_), &o);
    }
  }
}

void GradientObserver::on_light_sample(const path::Vertex& vertex, const path::LightSample& sample,
                                       bsdf::ScatterClass scatter_class, const path::Contribution& c) {
  add_to_suffix(c, Rgb(1.0f));
  if (open_ == 0) {
    return;
  }
  connect_pending(base_, vertex, &offsets_, &counters_);
  light_coupled(base_, sample, scatter_class, &offsets_, &counters_);
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Pending) {
      accumulator_.add(k, c, connect_to_lit_vertex(base_, vertex, sample, scatter_class, c, &o));
    } else if (o.stage == OffsetStage::Coupled) {
      accumulator_.add(k, c, copy_light_sample(base_, vertex, sample, scatter_class, c, o));
    } else if (o.stage == OffsetStage::Deeper) {
      accumulator_.add(k, c, share_light_sample(base_, vertex, sample, c, o));
    }
  }
}

// Pending offsets share the vertex at which the base enters the surface.
void GradientObserver::on_subsurface_entry(const path::Vertex& entry, const path::VertexSample& u) {
  if (open_ == 0) {
    return;
  }
  decouple_by_class(entry, u);
  connect_pending(base_, entry, &offsets_, &counters_);
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending && arrives(&o, entry)) {
      ++counters_.shifts_reconnected;
      share_vertex(base_, entry, &o);
      fail_if(o.include_kind() ? ShiftFailure::None : ShiftFailure::Class, &o);
    }
  }
}

void GradientObserver::on_subsurface_exit(const path::Vertex& entry, const path::SubsurfaceEvent& event) {
  accumulator_.scale_suffix(event.factor);
  if (open_ == 0) {
    return;
  }
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Coupled) {
      fail_if(replay_below(base_, entry, &o, &counters_), &o);
    } else if (o.stage == OffsetStage::Deeper) {
      o.state.throughput *= event.factor;
    }
  }
}

void GradientObserver::on_scattering(const path::Vertex& vertex, const path::VertexSample& u,
                                     const path::ScatterEvent& event) {
  accumulator_.scale_suffix(event.factor);
  if (open_ == 0) {
    return;
  }
  decouple_by_class(vertex, u);
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Deeper) {
      o.state.throughput *= event.factor;
    }
  }
  if (!has_offset_at(OffsetStage::Pending)) {
    return;
  }
  if (!reconnects(event.scatter_class)) {
    shift_before_specular(vertex, event);
  } else if (can_defer()) {
    defer_reconnection(vertex, event);
  } else {
    reconnect_pending(vertex, event);
  }
}

void GradientObserver::reconnect_pending(const path::Vertex& vertex, const path::ScatterEvent& event) {
  connect_pending(base_, vertex, &offsets_, &counters_);
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending && arrives(&o, vertex)) {
      reconnect(&o, vertex, event);
    }
  }
}

// Shifts class D before class R or T. The offset shares the base's vertex, and also its direction where the lobe is
// wide, or it continues with a ray of its own. Where a texture depends on the ray, the two paths may judge the lobe
// differently. The inverse shift would then differ too, so the shift fails.
void GradientObserver::shift_before_specular(const path::Vertex& vertex, const path::ScatterEvent& event) {
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending &&
        !shares_vertex(base_, o.vertex->point.position, vertex, event.scatter_class) &&
        !shares_direction(base_, o.vertex->point.position, vertex, event)) {
      fail_if(copy_direction(base_, event, &o, &counters_), &o);
    }
  }
  connect_pending(base_, vertex, &offsets_, &counters_);
  for (OffsetPath& o : offsets_) {
    if (o.stage != OffsetStage::Pending || !arrives(&o, vertex)) {
      continue;
    }
    shade_shared_vertex(base_, vertex, &o);
    const Vec3& y = o.vertex->point.position;
    const bool is_direction_shared = shares_direction(base_, y, vertex, event);
    if (is_direction_shared != shares_direction(base_, y, *o.shared_vertex, event)) {
      fail(ShiftFailure::Class, &o);
    } else if (is_direction_shared) {
      reconnect(&o, vertex, event);
    } else {
      ++counters_.shifts_reconnected;
      share_vertex(base_, vertex, &o);
      fail_if(o.include_kind() ? ShiftFailure::None : ShiftFailure::Class, &o);
    }
  }
}

// ---- Decoupling ----

// Decouples the offsets whose vertex differs in its classes from the base's, if the base's random number chooses
// different classes. Otherwise the event is copied; the random number is no longer a free coordinate, so the
// probabilities of the class are removed from r.
void GradientObserver::decouple_by_class(const path::Vertex& vertex, const path::VertexSample& u) {
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage != OffsetStage::Coupled || !o.copies_class_choice) {
      continue;
    }
    const bsdf::Closures& base = vertex.shade.closures;
    const bsdf::Closures& offset = o.vertex->shade.closures;
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

// Decouples offset k because of `cause`, and traces the rest of its path if `offset_continues`. `is_lit` says that
// light samples at its vertex are complete and that it scatters next.
void GradientObserver::decouple(int k, ShiftFailure cause, bool offset_continues, bool is_lit) {
  OffsetPath& o = offsets_[k];
  count_failure(cause, &counters_);
  if (offset_continues) {
    const path::PathResult& found = decoupled_tracer_.trace(base_, &o, is_lit, &counters_);
    for (int c = 0; c < context_.components.count(); ++c) {
      accumulator_.add_pair(k, c, Radiance(0.0f), found.radiance[size_t(c)], o.ratio);
    }
  }
  settle(OffsetStage::Decoupled, &o);
}

// ---- Deferred reconnection ----
//
// Behind the vertex of reconnection an offset differs from its base by a throughput and a ratio. Neither is needed
// until the base finds emission there, so until then no connection is traced and no vertex is shaded again. Half of all
// paths in rooms end without emission, and nearly all do where lights are hard to find. The base's vertex is kept in
// the meantime. base_ keeps its values from that vertex, because on_segment() does not change it while no offset is
// open.

// Returns whether all open offsets are pending, so that their reconnection can be deferred. Scenes with transparency
// are excluded, because transparent surfaces on the path would have to be counted in the meantime.
bool GradientObserver::can_defer() const {
  const auto pending = std::count_if(offsets_.begin(), offsets_.end(),
                                     [](const OffsetPath& o) { return o.stage == OffsetStage::Pending; });
  return !context_.has_transparency && pending == open_;
}

void GradientObserver::defer_reconnection(const path::Vertex& vertex, const path::ScatterEvent& event) {
  accumulator_.flush();  // from now on the suffix's weight starts at this event, whose factor reconnect() applies
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending) {
      o.stage = OffsetStage::Deferred;
    }
  }
  open_ = 0;
  deferred_vertex_ = &vertex;
  deferred_event_ = event;
  is_on_deferred_segment_ = true;
}

// Performs the deferred reconnection because the base has found emission. The result equals that of an immediate
// reconnection in on_scattering() followed by the notifications since.
void GradientObserver::resume_reconnection() {
  const path::Vertex& vertex = *std::exchange(deferred_vertex_, nullptr);
  const Rgb weight_since = accumulator_.suffix_weight();
  accumulator_.flush();
  bool was_deferred[film::kOffsets];
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    was_deferred[k] = o.stage == OffsetStage::Deferred;
    if (was_deferred[k]) {
      o.stage = OffsetStage::Pending;
      ++open_;
    }
  }
  reconnect_pending(vertex, deferred_event_);
  for (int k = 0; k < film::kOffsets; ++k) {
    if (was_deferred[k]) {
      offsets_[k].state.throughput *= weight_since;
    }
  }
  if (is_on_deferred_segment_) {
    begin_segment(latest_.source, *latest_.state, *latest_.segment, *latest_.vertex);
  } else {
    on_emission_complete();
  }
}

void GradientObserver::add_to_suffix(const path::Contribution& c, const Rgb& segment_weight) {
  if (deferred_vertex_ != nullptr) {
    resume_reconnection();
  }
  accumulator_.add_to_suffix(c, segment_weight);
}

// ---- Stages ----

bool GradientObserver::has_offset_at(OffsetStage stage) const {
  return std::any_of(offsets_.begin(), offsets_.end(), [stage](const OffsetPath& o) { return o.stage == stage; });
}

bool GradientObserver::arrives(OffsetPath* offset, const path::Vertex& vertex) {
  if (!offset->connection.is_open) {
    settle(OffsetStage::Failed, offset);  // connect_pending() has counted the cause
  } else if (!offset->connection.may_scatter) {
    fail(ShiftFailure::Occluded, offset);
  } else if (!sees_same_side(*offset, vertex)) {
    fail(ShiftFailure::Side, offset);
  }
  return offset->stage == OffsetStage::Pending;
}

void GradientObserver::reconnect(OffsetPath* offset, const path::Vertex& vertex, const path::ScatterEvent& event) {
  const ShiftFailure failure = reconnect_at(base_, vertex, event, offset);
  if (failure != ShiftFailure::None) {
    fail(failure, offset);
    return;
  }
  ++counters_.shifts_reconnected;
  if (offset->connection.scatters_alike) {
    share_rest(offset);  // both paths are taken to have the same density at the vertex
  } else {
    offset->stage = OffsetStage::Reconnected;
  }
}

void GradientObserver::share_rest(OffsetPath* offset) {
  if (!(offset->ratio > 0.0f) || !is_finite(offset->ratio)) {
    fail(ShiftFailure::Jacobian, offset);
  } else if (!offset->blurs_alike) {
    fail(ShiftFailure::Class, offset);
  } else if (offset->state.ray.state.transparent_depth > base_.state.ray.state.transparent_depth) {
    offset->stage = OffsetStage::Deeper;
  } else {
    settle(OffsetStage::Shared, offset);
  }
}

void GradientObserver::fail_if(ShiftFailure failure, OffsetPath* offset) {
  if (failure != ShiftFailure::None) {
    fail(failure, offset);
  }
}

void GradientObserver::settle(OffsetStage stage, OffsetPath* offset) {
  accumulator_.flush();
  open_ -= is_final(offset->stage) ? 0 : 1;
  offset->stage = stage;
  if (stage != OffsetStage::Shared) {
    offset->state.throughput = Rgb(0.0f);
  }
  if (stage == OffsetStage::Failed) {
    offset->ratio = 0.0f;
  }
}

}  // namespace gradus::gradient
